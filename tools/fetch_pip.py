"""Install pip into this environment where Python comes without `ensurepip`.

Some distributions ship Python without the means to install anything. One pinned wheel,
checked against its hash, is enough to go on from.
"""

import hashlib
import subprocess
import sys
import tempfile
import urllib.request
from pathlib import Path

URL = (
    "https://files.pythonhosted.org/packages/07/25/"
    "ee8c38ae72d66b844ce8eb9711ba905dba21ca1a8a0c960057c41cd23337/"
    "pip-26.3-py3-none-any.whl"
)
SHA256 = "f3b60b20ffaadd4415ed7957212a38ac63fa4c5fa375bd0f4a797777940fad13"
TIMEOUT_S = 60.0


def main() -> None:
    """Download the wheel, check it, and let it install itself.

    Raises:
        SystemExit: The file is not the expected one, or pip refuses to install.
    """
    with urllib.request.urlopen(URL, timeout=TIMEOUT_S) as answer:
        content = answer.read()
    digest = hashlib.sha256(content).hexdigest()
    if digest != SHA256:
        sys.exit(f"{URL} has SHA-256 {digest}, expected {SHA256}: nothing installed")
    with tempfile.TemporaryDirectory() as directory:
        wheel = Path(directory) / URL.rpartition("/")[2]
        wheel.write_bytes(content)
        command = [sys.executable, str(wheel / "pip"), "install", "--quiet"]
        installed = subprocess.run([*command, "--no-index", str(wheel)], check=False)
    sys.exit(installed.returncode)


if __name__ == "__main__":
    main()
