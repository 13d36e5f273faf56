"""How the loop does."""


def test_the_loop_reports_and_can_be_asked_to_start_counting_anew(client, station):
    station.loop.step(3)
    report = client.loop()
    assert report.rate == 1000.0
    assert report.period == 0.001
    assert report.cycles == 4
    assert report.total.count == 4

    assert client.reset_loop_statistics().cycles == 0
    assert client.loop().cycles == 0


def test_the_report_has_the_time_of_each_controller(spring, station):
    station.loop.step(3)

    times = spring.loop().controllers["spring"]
    assert times == spring.controller("spring").time
    assert times.count == 3

    assert spring.reset_loop_statistics().controllers["spring"].count == 0
