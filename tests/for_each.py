"""One test over many cases, which lists every case that fails."""

import functools
import inspect

from _pytest.outcomes import Failed


def for_each(names, cases, ids=str):
    """Run a test for each of some cases, in one test; all that fail are listed.

    A failure of one case hides no other. Fixtures are set up once for all cases: for
    what has to be new in every case `pytest.mark.parametrize` is the right mark.

    Args:
        names: Parameters of the test that a case fills, as `parametrize` has them.
        cases: The cases, at least one; tuples if there are several names. A function
            is asked for them when the test runs.
        ids: Returns how a case is called.
    """
    parts = [name.strip() for name in names.split(",")]

    def listed():
        found = list(cases() if callable(cases) else cases)
        assert found, f"there is no case of {names}"
        return found

    def decorate(test):
        wanted = inspect.signature(test)

        @functools.wraps(test)
        def run(**fixtures):
            found, all_cases = [], listed()
            for case in all_cases:
                values = [case] if len(parts) == 1 else case
                try:
                    test(**dict(zip(parts, values, strict=True)), **fixtures)
                except (Exception, Failed, SystemExit) as error:  # noqa: BLE001 - it is told
                    found.append(f"{ids(case)}: {type(error).__name__}: {error}")
            assert not found, _listed(found, len(all_cases))

        rest = [wanted.parameters[n] for n in wanted.parameters if n not in parts]
        run.__signature__ = wanted.replace(parameters=rest)
        return run

    return decorate


def _listed(found, number):
    return "\n".join([f"{len(found)} of {number} cases:", *found])
