"""Refuse commit subjects since the last release that are not `area: verb object`.

A subject has at most 60 characters, so that `git log --oneline` shows it whole, and its
area tells where to look. Reasons belong in the body. Merges are not judged.
"""

import re
import subprocess
import sys

MOST = 60
FORM = re.compile(r"[a-z][\w /.,-]*: [a-z]")
SHARED = {"f6e69603"}
"""Commits with a longer subject in a history that is shared, and so stays."""


def git(*arguments: str) -> str | None:
    """Return what git prints; None when it fails, as outside a clone."""
    done = subprocess.run(
        ["git", *arguments], capture_output=True, text=True, check=False
    )
    return done.stdout.strip() if done.returncode == 0 else None


def complaint(subject: str) -> str | None:
    """Return why a subject is refused; None when it is not."""
    if len(subject) > MOST:
        return f"has {len(subject)} characters, {MOST} are allowed"
    if not FORM.match(subject):
        return "is not of the form `area: verb object`"
    return None


def main() -> int:
    """Print the refused subjects; return 1 when there are some."""
    # A clone need not have the tags; the changelog has the releases, too.
    dated = ("-G", r"^## \[[0-9]", "--", "CHANGELOG.md")
    last = git("describe", "--tags", "--abbrev=0") or git(
        "log", "-1", "--format=%H", *dated
    )
    if not last:
        print("subjects: no release to begin at; nothing is checked")
        return 0
    listed = git("log", "--no-merges", "--format=%h %s", f"{last}..HEAD") or ""
    found = 0
    for line in listed.splitlines():
        commit, _, subject = line.partition(" ")
        why = complaint(subject)
        if why is not None and commit[:8] not in SHARED:
            found += 1
            print(f"{commit} '{subject}' {why}", file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
