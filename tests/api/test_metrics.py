"""Prometheus' figures: there, right, and never going back."""

import pytest
from prometheus_client.parser import text_string_to_metric_families

pytestmark = pytest.mark.usefixtures("spring")


@pytest.fixture
def figures(operator):
    """Return a function that asks for all samples by name and labels."""

    def ask():
        answer = operator.get("/metrics")
        assert answer.status_code == 200
        assert answer.headers["content-type"].startswith("text/plain")
        return {
            (sample.name, *sorted(sample.labels.values())): sample.value
            for family in text_string_to_metric_families(answer.text)
            for sample in family.samples
        }

    return ask


def test_figures_need_a_token(http):
    assert http.get("/metrics").status_code == 401


def test_figures_are_those_of_the_station(figures, station):
    station.loop.step(10)
    station.loop.delay_next_cycle(3)
    station.loop.step()
    found = figures()

    assert found["station_cycles_total",] == station.loop.cycle
    assert found["station_skipped_deadlines_total",] == 3
    assert found["station_time_seconds_total",] == pytest.approx(station.loop.time)
    assert found["station_controller_running", "spring"] == 1
    assert found["station_controller_updates_total", "spring"] >= 11
    assert found["station_controller_faulty", "spring"] == 0
    assert found["station_stopped",] == 0
    assert ("station_controller_update_seconds", "0.99", "spring") in found
    assert ("station_loop_phase_seconds", "0.5", "read") in found
    assert ("process_resident_memory_bytes",) in found


def test_counters_never_go_back(figures, spring, station):
    station.loop.delay_next_cycle(3)
    station.loop.step(10)
    before = figures()

    spring.reset_loop_statistics()
    station.manager.reset_statistics()
    after = figures()

    counters = {key for key in before if key[0].endswith("_total")}
    assert len(counters) == 9
    assert all(after[key] >= before[key] for key in counters)
    assert station.loop_report().skipped == 0
    station.loop.step(2)
    assert (
        figures()["station_controller_updates_total", "spring"]
        == after["station_controller_updates_total", "spring"] + 2
    )


def test_a_stop_and_a_fault_are_told(figures, station):
    station.manager.get_controller("spring").joint = None
    station.loop.step()
    station.stop("test")
    station.loop.step()
    found = figures()

    assert found["station_controller_faulty", "spring"] == 1
    assert found["station_controller_running", "spring"] == 0
    assert found["station_stopped",] == 1
    assert found["station_epochs_total",] == station.epoch
