"""What the page says when something of it, or of its stop, does not work."""

import pytest

from tests.browser.workspace_page import wait_until

pytestmark = pytest.mark.long
NOT_STOPPED = "NOT stopped by this page. Press the emergency stop."


def test_the_strip_says_what_the_terminal_said_of_the_robot(
    workspace, client, running_station
):
    shown = workspace.page.locator("#robot").inner_text()
    assert shown == running_station.robot == client.status().robot_label
    assert shown == "SIMULATION"


def test_a_stop_that_fails_sends_its_user_to_the_emergency_stop(workspace, client):
    page, notice = workspace.page, workspace.page.locator("#notice")
    page.route("**/stop", lambda route: route.abort())
    page.locator("#stop").click()
    notice.get_by_text(NOT_STOPPED, exact=True).wait_for()
    assert client.status().stop_state == "armed"
    page.wait_for_timeout(1000)
    assert notice.inner_text() == NOT_STOPPED
    page.unroute("**/stop")
    page.locator("#stop").click()  # the next one is carried out
    notice.wait_for(state="hidden")
    assert client.status().stop_state == "stopped"
    client.release_stop()
    client.release_stop(arm=True)
    page.locator("#motion").get_by_text("allowed", exact=True).wait_for()


def test_what_a_failed_stop_says_stays_until_the_link_is_back(workspace):
    page, notice = workspace.page, workspace.page.locator("#notice")
    for path in ("**/stop", "**/state"):
        page.route(path, lambda route: route.abort())
    page.locator("#stop").click()
    notice.get_by_text(NOT_STOPPED, exact=True).wait_for()
    page.wait_for_timeout(6000)  # longer than it stays while all is well
    assert notice.inner_text() == NOT_STOPPED
    for path in ("**/stop", "**/state"):
        page.unroute(path)
    notice.wait_for(state="hidden")


def test_an_answer_that_was_cut_off_is_a_lost_link_and_no_empty_answer(workspace):
    page = workspace.page
    page.route("**/recordings", lambda route: route.fulfill(body='{"recordings": ['))
    look = """async () => {
        const { api } = await import('/static/lib/station.js');
        return await api('GET', '/recordings').catch((error) => error.code);
    }"""
    assert page.evaluate(look) == "unreachable"
    page.unroute("**/recordings")


def _without(path):
    def begin(tab):
        tab.route(f"**/static/{path}", lambda route: route.fulfill(status=503))

    return begin


@pytest.mark.parametrize("part", ["panels/plots.js", "lib/dom.js", "workspace.js"])
def test_a_script_of_the_docks_that_does_not_load_is_told(open_tab, client, part):
    with open_tab(_without(part)) as page:
        told = page.locator("#unloaded")
        told.get_by_text("its docks are missing. STOP works.").wait_for()
        page.locator("#stop").click()
        assert wait_until(lambda: client.status().stop_state == "stopped")
        client.release_stop()
        client.release_stop(arm=True)
        page.unroute(f"**/static/{part}")
        told.get_by_role("link", name="Reload the page").click()
        page.locator('.dock[data-dock="plots"] .plot').first.wait_for()
        assert told.is_hidden()


def test_a_stop_whose_script_does_not_load_is_told(open_tab):
    with open_tab(_without("page.js")) as page:
        told = page.locator("#unloaded")
        told.get_by_text("Its STOP does not work: press the emergency stop").wait_for()


def test_a_page_without_any_script_says_so(open_tab):
    def begin(tab):
        for path in ("page.js", "workspace.js"):
            _without(path)(tab)

    with open_tab(begin) as page:
        told = page.locator("#unloaded")
        assert not told.is_visible()  # it may still be loading
        told.wait_for()


def test_bursts_of_missed_deadlines_are_one_line_of_the_timeline(workspace):
    page = workspace.page

    def answer(route):
        told = route.fetch().json()
        event = told["events"][-1]
        more = [
            {
                **event,
                "id": event["id"] + 1 + n,
                "kind": "overrun",
                "severity": "warning",
                "what": "",
                "who": "",
                "text": f"The control loop missed {n} deadlines.",
            }
            for n in range(40)
        ]
        route.fulfill(json={**told, "events": [*told["events"], *more]})

    page.route("**/api/v1/events?*", answer)
    dock = workspace.dock("timeline")
    workspace.button("timeline", "Events").click()
    line = dock.locator(".log .row", has_text="alike since")
    line.get_by_text("missed 39 deadlines. (4").wait_for()
    assert dock.locator(".log .row", has_text="missed 38").count() == 0
    page.unroute("**/api/v1/events?*")
