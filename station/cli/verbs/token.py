"""Verb `token`: make, list and revoke named tokens."""

from argparse import Namespace
from datetime import datetime

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import say, say_model, say_models, say_table


def token(options: Namespace) -> int:
    """Make, list or revoke named tokens.

    Raises:
        UsageError: `create` or `revoke` without a name.
    """
    if options.action != "list" and options.name is None:
        raise UsageError(
            f"Whose token? `{options.action}` needs a name.",
            remedy=f"station token {options.action} NAME",
        )
    with open_client(options) as client:
        if options.action == "list":
            found = client.tokens.list()
            if options.json:
                say_models(found)
            else:
                rows = [(t.name, t.role, _time(t.expires_at)) for t in found]
                say_table(("name", "role", "expires"), rows)
        elif options.action == "create":
            made = client.tokens.create(
                options.name, options.role, expires=options.expires
            )
            say_model(made) if options.json else say(made.token)
        else:
            gone = client.tokens.revoke(options.name)
            say_model(gone) if options.json else say(f"{gone.name} has no token now.")
    return 0


def _time(stamp: float | None) -> str:
    if stamp is None:
        return "never"
    return f"{datetime.fromtimestamp(stamp).astimezone():%Y-%m-%d %H:%M:%S}"
