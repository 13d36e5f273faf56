"""Nothing goes wrong unless it is ordered."""

from station.hw.mock import MockScript


def test_a_new_mock_script_has_no_fault():
    script = MockScript()

    assert script.refusal is None
    assert not script.failing
    assert not script.nan_sensors
    assert not script.slow_cycles
    assert script.read_error is None
    assert script.switch_cycles == 0


def test_mock_scripts_do_not_share_their_sets():
    MockScript().failing.add("arm")

    assert not MockScript().failing
