"""A repair in words."""

from station.core.description.urdf_repair import Repair


def test_sentence_has_the_old_value_if_there_is_one() -> None:
    told = Repair("mass", "link 'a'", "it has none", "", "1 g")
    assert told.sentence() == "link 'a': it has none; now 1 g"
    told = Repair("mass", "link 'a'", "it has none", "0", "1 g")
    assert told.sentence() == "link 'a': it has none; now 1 g (was 0)"
