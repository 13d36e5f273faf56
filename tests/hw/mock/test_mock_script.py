"""Nothing goes wrong unless it is ordered."""

from station.hw.mock.mock_script import MockScript


def test_the_empty_script_orders_nothing():
    script = MockScript()

    assert script.refusal is None
    assert not script.failing
    assert not script.nan_sensors
    assert not script.slow_cycles
    assert script.read_error is None
    assert script.switch_cycles == 0


def test_scripts_share_nothing():
    MockScript().failing.add("arm")

    assert not MockScript().failing
