"""An import contract by permission: what is not listed may not be imported.

import-linter's own `forbidden` contract needs every forbidden name. Here a package
lists the few things it may see, so that a new dependency is noticed when it is made.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from importlinter import Contract, ContractCheck, fields, output

if TYPE_CHECKING:
    from grimp import ImportGraph


class AllowedImportsContract(Contract):
    """Keep the direct imports of one package within a list.

    The package itself, the root package (which holds the version) and the standard
    library are always allowed. A package that does not exist keeps the contract.
    Options: `package`; `allowed`, whose entries are third-party packages or packages of
    the station; and `permitted_imports`, single imports written `importer -> imported`.
    """

    type_name = "allowed_imports"

    package = fields.StringField()
    allowed = fields.SetField(subfield=fields.StringField())
    permitted_imports = fields.SetField(subfield=fields.StringField(), required=False)

    def check(self, graph: ImportGraph, verbose: bool) -> ContractCheck:  # noqa: FBT001 - import-linter's signature
        """Compare every direct import of the package with the list.

        Args:
            graph: The imports of the whole project, third-party packages included.
            verbose: Unused; the contract is quick.

        Returns:
            Whether the contract is kept; `metadata["violations"]` holds one
            `importer -> imported (line)` for each import that is not allowed.
        """
        del verbose
        root = self.package.partition(".")[0]
        allowed = {self.package, *self.allowed}
        permitted = self.permitted_imports or set()
        violations = [
            f"{importer} -> {imported} (line {_line(graph, importer, imported)})"
            for importer in _modules_of(graph, self.package)
            for imported in sorted(graph.find_modules_directly_imported_by(importer))
            if imported != root
            and not _is_allowed(imported, allowed)
            and f"{importer} -> {imported}" not in permitted
        ]
        return ContractCheck(kept=not violations, metadata={"violations": violations})

    def render_broken_contract(self, check: ContractCheck) -> None:
        """Print the imports that are not allowed and what to do about them."""
        for violation in check.metadata["violations"]:
            output.print_error(violation, bold=False)
        output.print(
            f"{self.package} may import {', '.join(sorted(self.allowed))} and the "
            "standard library. Move the code, or widen the list in pyproject.toml "
            "and say why in the commit."
        )


def _modules_of(graph: ImportGraph, package: str) -> list[str]:
    if package not in graph.modules:
        return []
    return sorted({package, *graph.find_descendants(package)})


def _is_allowed(imported: str, allowed: set[str]) -> bool:
    if imported.partition(".")[0] in sys.stdlib_module_names:
        return True
    return any(imported == name or imported.startswith(f"{name}.") for name in allowed)


def _line(graph: ImportGraph, importer: str, imported: str) -> object:
    details = graph.get_import_details(importer=importer, imported=imported)
    return details[0]["line_number"] if details else "?"
