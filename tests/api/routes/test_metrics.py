"""The route of the figures."""


def test_a_viewer_may_read_the_figures(http):
    http.headers["Authorization"] = "Bearer viewer-token"

    assert "station_cycles_total 1.0" in http.get("/metrics").text
