"""Follow a guide of docs/ word by word in an empty folder, as a reader would."""

import json
import os
import re
import shlex
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"Save as `([^`]+)`[^`\n]*(?:`[^`]+`)?[^`\n]*:\s*$")
PATIENCE = 30.0
"""How long the station may take to come up, and a joint to move [s]."""


class Reader:
    """Somebody with the station installed, who does what a guide says.

    Args:
        guide: File name in docs/.
        folder: An empty folder.
    """

    def __init__(self, guide: str, folder: Path) -> None:
        self._text = (ROOT / "docs" / guide).read_text()
        self._folder = folder / "work"
        self._folder.mkdir()
        tools = folder / "bin"
        tools.mkdir()
        station = tools / "station"
        station.write_text(
            f"#!{sys.executable}\n"
            f"import sys\nsys.path.append({str(ROOT)!r})\n"
            "from station.cli import main\nsys.exit(main())\n"
        )
        station.chmod(0o755)
        runtime = folder / "runtime"
        runtime.mkdir(mode=0o700)
        self._environment = {
            "PATH": f"{tools}:{os.environ['PATH']}",
            "XDG_RUNTIME_DIR": str(runtime),
            "HOME": str(folder),
        }
        self._station: subprocess.Popen[str] | None = None

    def __enter__(self) -> "Reader":
        return self

    def __exit__(self, *_: object) -> None:
        if self._station is not None:
            self._station.terminate()
            self._station.wait(10.0)
            if self._station.stdout is not None:
                self._station.stdout.close()

    def follow(self) -> None:
        """Save every file and type every command, in the order of the guide."""
        for match in BLOCK.finditer(self._text):
            language, content = match.groups()
            before = self._text[: match.start()].rstrip()
            named = FILE.search(before.rpartition("\n\n")[2].replace("\n", " "))
            if named:
                (self._folder / named.group(1)).write_text(content)
            elif language == "sh":
                for line in content.splitlines():
                    self._type(line)

    def positions(self) -> dict[str, float]:
        """Return the joint positions [rad] by name, as `station echo` prints them."""
        done = self._run(["station", "echo", "joint_states", "-n", "1", "--json"])
        line = done.strip().splitlines()[-1]
        data = json.loads(line)
        state = data.get("data", data)
        return dict(zip(state["name"], state["position"], strict=True))

    def wait_for(self, joint: str, position: float, tolerance: float = 0.01) -> None:
        """Return when a joint is at a position [rad]; fail when it never gets there."""
        deadline = time.monotonic() + PATIENCE
        while abs(self.positions()[joint] - position) > tolerance:
            assert time.monotonic() < deadline, self.positions()

    def run_pytest(self) -> None:
        """Run the guide's own test."""
        self._environment["PYTHONPATH"] = f"{self._folder}:{ROOT}"
        self._run([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"])

    def _type(self, line: str) -> None:
        command = line.partition("#")[0].strip()
        if command.startswith("export "):
            name, _, value = command.removeprefix("export ").partition("=")
            self._environment[name] = value.replace("$PWD", str(self._folder))
        elif command.startswith("station run"):
            self._start([*shlex.split(command), "--port", "0"])
        elif command:
            self._run(shlex.split(command))

    def _start(self, command: list[str]) -> None:
        self._station = subprocess.Popen(
            command,
            cwd=self._folder,
            env=self._environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        assert self._station.stdout is not None
        line = self._station.stdout.readline()
        assert "http" in line, line + self._station.stdout.read()

    def _run(self, command: list[str]) -> str:
        done = subprocess.run(
            command,
            cwd=self._folder,
            env=self._environment,
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )
        assert done.returncode == 0, f"{command}: {done.stdout}{done.stderr}"
        return done.stdout
