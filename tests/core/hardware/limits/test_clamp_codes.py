"""Every limit that changes a command has a number, which is its place in the names."""

from station.core.hardware.limits import clamp_codes


def test_each_number_is_the_place_of_its_name():
    codes = {k: v for k, v in vars(clamp_codes).items() if isinstance(v, int)}

    assert {name.upper() for name in clamp_codes.NAMES} == set(codes)
    for name, code in codes.items():
        assert clamp_codes.NAMES[code] == name.lower()
