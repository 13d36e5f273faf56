"""Recordings and incidents over HTTP."""

import pytest

from station.api.app import Kept, create_app
from station.client import ApiError, StationClient
from station.records.record_store import RecordStore
from station.records.recorder import Recorder
from station.records.recording_reader import read_trajectory
from tests.api.conftest import OPERATOR, URL, VIEWER, AppTransport


@pytest.fixture
def recorder(station, tmp_path):
    """Return a recorder that the tests drain."""
    stores = RecordStore(tmp_path / "recordings"), RecordStore(tmp_path / "incidents")
    recorder = Recorder(station, *stores)
    yield recorder
    recorder.close()


@pytest.fixture
def app(station, authenticator, recorder):
    """Return the app with a recorder."""
    return create_app(station, authenticator, kept=Kept(recorder=recorder))


def _run(station, recorder, cycles):
    for _ in range(0, cycles, 200):
        station.loop.step(200)
        recorder.drain()


def test_a_recording_is_started_stopped_read_and_deleted(
    client, station, recorder, tmp_path
):
    started = client.recordings.start("pick", "a note")
    _run(station, recorder, 400)
    assert client.status().recording.identifier == started.identifier
    assert client.recordings.get(started.identifier).state == "recording"
    stopped = client.recordings.stop()

    assert (stopped.state, stopped.cycles, stopped.lost) == ("stopped", 400, 0)
    assert client.recordings.list() == [stopped]
    path = client.recordings.download(started.identifier, tmp_path / "x.mcap")
    assert len(read_trajectory(path).cycle) == 400
    found = client.recordings.trajectory(started.identifier, rate=100.0)
    assert (found.name, len(found.time), found.position[0]) == (["j"], 40, [0.25])
    assert client.recordings.delete(started.identifier) == stopped
    assert client.recordings.list() == []


def test_incidents_are_listed_and_read(client, station, recorder, tmp_path):
    client.stop("a test")
    _run(station, recorder, 2600)

    (incident,) = client.incidents.list()
    assert incident.causes == ["The station was stopped: a test."]
    assert client.incidents.get(incident.identifier) == incident
    path = client.incidents.download(incident.identifier, tmp_path / "i.mcap")
    assert len(read_trajectory(path).cycle) == incident.cycles
    assert client.incidents.trajectory(incident.identifier).name == ["j"]


def test_a_table_is_streamed_with_a_choice_of_its_columns(
    client, station, recorder, tmp_path
):
    client.recordings.start("pick")
    _run(station, recorder, 400)
    client.recordings.stop()

    path = client.recordings.download_table(
        "pick",
        tmp_path / "x.csv",
        channels=["joint_states/position", "commands/effort"],
        joints=["j"],
        rate=100.0,
    )

    head, *rows = path.read_text().splitlines()
    assert head == (
        "cycle,time,period,epoch,joint_states/position/j,commands/effort/command/j"
    )
    assert len(rows) == 40
    assert rows[0].split(",")[:1] + rows[0].split(",")[4:] == ["2", "0.25", "0.0"]
    with pytest.raises(ApiError, match="no joint 'k'") as caught:
        client.recordings.download_table("pick", tmp_path / "y.csv", joints=["k"])
    assert caught.value.status == 409
    assert not (tmp_path / "y.csv").exists()


def test_a_damaged_file_is_a_problem_with_a_remedy(client, station, recorder, tmp_path):
    identifier = client.recordings.start().identifier
    _run(station, recorder, 400)
    client.recordings.stop()
    path = recorder.store.file(identifier)
    data = bytearray(path.read_bytes())
    data[data.index(b"lz4") + 60] ^= 1
    path.write_bytes(data)

    for ask in (
        lambda: client.recordings.trajectory(identifier),
        lambda: client.recordings.download_table(identifier, tmp_path / "x.csv"),
    ):
        with pytest.raises(ApiError, match="damaged") as caught:
            ask()
        assert (caught.value.status, caught.value.code) == (409, "recording_damaged")
        assert "recover-file" in caught.value.remedy


@pytest.mark.parametrize(
    ("ask", "status"),
    [
        (lambda c: c.recordings.get("nothing"), 404),
        (lambda c: c.recordings.stop("nothing"), 404),
        (lambda c: c.recordings.delete("nothing"), 404),
        (lambda c: c.recordings.trajectory("nothing"), 404),
        (lambda c: c.recordings.trajectory("nothing", rate=-1.0), 422),
        (lambda c: c.recordings.get("-x"), 422),
        (lambda c: c.incidents.get("nothing"), 404),
    ],
)
def test_what_is_not_possible_is_refused(client, ask, status):
    with pytest.raises(ApiError) as caught:
        ask(client)
    assert caught.value.status == status


def test_what_runs_is_neither_read_nor_deleted_nor_started_twice(client, tmp_path):
    running = client.recordings.start().identifier
    for ask in (
        lambda: client.recordings.start(),
        lambda: client.recordings.delete(running),
        lambda: client.recordings.download(running, tmp_path / "x.mcap"),
        lambda: client.recordings.trajectory(running),
    ):
        with pytest.raises(ApiError) as caught:
            ask()
        assert caught.value.status == 409
    assert not (tmp_path / "x.mcap").exists()
    with pytest.raises(LookupError, match="Nothing is being recorded"):
        client.recordings.stop(client.recordings.stop().identifier and None)


def test_viewers_read_and_change_nothing(http):
    http.headers["Authorization"] = f"Bearer {VIEWER}"

    assert http.get("/api/v1/recordings").json() == {"recordings": []}
    assert http.get("/api/v1/incidents").json() == {"recordings": []}
    for method, path in (
        ("POST", "/recordings"),
        ("POST", "/recordings/x/stop"),
        ("DELETE", "/recordings/x"),
    ):
        assert http.request(method, f"/api/v1{path}").status_code == 403


def test_a_station_without_recorder_says_so(station, authenticator):
    transport = AppTransport(create_app(station, authenticator))
    with StationClient(URL, OPERATOR, transport=transport) as client:
        for ask in (client.recordings.list, client.incidents.list):
            with pytest.raises(ApiError, match="records nothing"):
                ask()
        assert client.status().recording is None


def test_notes_become_events_of_recordings_and_incidents(client, station, recorder):
    client.recordings.start("pick")
    _run(station, recorder, 400)
    stopped = client.recordings.stop()
    note = client.recordings.add_note("pick", "it slipped", 0.1, 0.2)
    assert (note.time, note.until, note.kind) == (0.1, 0.2, "note")
    assert note.details["who"] == "operator"
    (found,) = client.recordings.events("pick")
    assert (found.text, found.time) == ("it slipped", pytest.approx(0.1))
    (listed,) = client.recordings.list()
    size = recorder.store.file(stopped.identifier).stat().st_size
    assert (listed.size, listed.cycles) == (size, 400)
    with pytest.raises(ApiError, match="cannot lie at 9 s") as caught:
        client.recordings.add_note("pick", "nowhere", 9.0)
    assert caught.value.status == 409

    client.stop("a test")
    _run(station, recorder, 2600)
    (incident,) = client.incidents.list()
    (cause,) = client.incidents.events(incident.identifier)
    client.incidents.add_note(incident.identifier, "the cable", cause.time)
    texts = [event.text for event in client.incidents.events(incident.identifier)]
    assert sorted(texts) == sorted([incident.causes[0], "the cable"])


def test_a_file_is_uploaded_and_listed_like_an_own_recording(
    client, station, recorder, tmp_path
):
    client.recordings.start("pick")
    _run(station, recorder, 400)
    own = client.recordings.stop()
    path = client.recordings.download(own.identifier, tmp_path / "x.mcap")
    client.recordings.delete(own.identifier)

    found = client.recordings.upload(path, "tuesday")

    assert (found.name, found.state, found.is_uploaded) == ("tuesday", "stopped", True)
    # Within a second: the station tells when the recording began, the file its first
    # cycle.
    assert found.started_at[:13] == own.started_at[:13]
    same = ("cycles", "first_cycle", "last_cycle", "lost", "duration", "size")
    assert [getattr(found, n) for n in same] == [getattr(own, n) for n in same]
    assert client.recordings.list() == [found]
    again = client.recordings.download(found.identifier, tmp_path / "again.mcap")
    assert again.read_bytes() == path.read_bytes()
    assert not list(recorder.store.folder.glob("*.part"))


def _cut(data):
    return data[: len(data) // 2]


def _damaged(data):
    middle = len(data) // 2
    return data[:middle] + bytes(64) + data[middle + 64 :]


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (_cut, "not whole"),
        (_damaged, "not whole"),
        (lambda _: b"", "no MCAP file"),
        (lambda _: b"cycle,time\n1,2\n" * 100, "no MCAP file"),
        (lambda data: data[:8] + data[-8:], "no cycles"),
    ],
)
def test_a_file_that_is_no_whole_recording_is_not_kept(
    client, station, recorder, tmp_path, change, why
):
    client.recordings.start()
    _run(station, recorder, 400)
    own = client.recordings.stop()
    path = client.recordings.download(own.identifier, tmp_path / "x.mcap")
    path.write_bytes(change(path.read_bytes()))

    with pytest.raises(ApiError, match=why) as refused:
        client.recordings.upload(path)

    assert refused.value.status == 409
    assert client.recordings.list() == [own]
    assert not list(recorder.store.folder.glob("*.part"))


def test_an_upload_is_for_operators_and_of_a_name_for_a_file(app, client, tmp_path):
    path = tmp_path / "x.mcap"
    path.write_bytes(b"x" * 300_000)  # more than any other body may have
    with StationClient(URL, VIEWER, transport=AppTransport(app)) as watching:
        with pytest.raises(ApiError) as refused:
            watching.recordings.upload(path)
        assert refused.value.code == "operator_needed"
    with pytest.raises(ApiError) as refused:
        client.recordings.upload(path, "../x")
    assert refused.value.status == 422
