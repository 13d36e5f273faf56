"""The words of the verbs about recordings."""

from station.cli.arguments import build_parser


def test_the_defaults_are_the_file_itself():
    options = build_parser().parse_args(["record", "get", "x"])
    assert (options.action, options.name, options.format, options.output) == (
        "get", "x", "mcap", None,
    )  # fmt: skip


def test_recovery_needs_no_station():
    options = build_parser().parse_args(["recover_file", "x.mcap"])
    assert not hasattr(options, "url")
