"""Prometheus' figures: there, right, and never going back."""

import re

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
    assert ("station_controller_update_seconds", "p99", "spring") in found
    assert ("station_loop_phase_seconds", "p50", "read") in found
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
    assert station.loop.report().skipped == 0
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


OF_KIND = {"le": "histogram", "quantile": "summary"}
SUFFIXES = ("_count", "_sum", "_bucket")


def test_figures_follow_the_rules_that_promtool_checks(operator):
    text = operator.get("/metrics").text
    families = list(text_string_to_metric_families(text))

    assert len(families) > 20
    for family in families:
        assert family.documentation, family.name
        assert re.fullmatch(r"[a-z][a-z0-9_]*[a-z0-9]", family.name)
        assert "total" not in family.name
        for sample in family.samples:
            is_counter = sample.name.endswith("_total")
            assert is_counter == (family.type == "counter"), sample.name
            assert not sample.name.endswith(SUFFIXES)
            kinds = {OF_KIND.get(name, family.type) for name in sample.labels}
            assert kinds <= {family.type}, sample.name
            assert "__" not in "".join(sample.labels)
