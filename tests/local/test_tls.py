"""TLS: files that can be used, and certificates that are trusted."""

import os
import ssl
from dataclasses import replace

import pytest

from station.local.private_files import process_start
from station.local.station_locator import RunningStation, write_runtime_file
from station.local.tls import CA_VARIABLE, TlsFilesError, trust
from tests.certificates import make_certificate

URL = "https://127.0.0.1:8000"


@pytest.fixture(autouse=True)
def nothing_set(tmp_path, monkeypatch):
    """Let no station run and nothing be set."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    monkeypatch.delenv(CA_VARIABLE, raising=False)


@pytest.fixture
def files(tmp_path):
    return make_certificate(tmp_path)


def test_files_that_belong_together_can_be_used(files):
    assert files.context().minimum_version >= ssl.TLSVersion.TLSv1_2


def test_a_missing_file_is_named(files, tmp_path):
    for broken in (
        replace(files, certificate=tmp_path / "none.crt"),
        replace(files, key=tmp_path / "none.key"),
    ):
        with pytest.raises(
            TlsFilesError, match=r"none\.\w+ cannot be read: No such file"
        ):
            broken.context()


def test_a_key_of_another_certificate_is_refused(files, tmp_path):
    other = make_certificate(tmp_path, name="other")

    with pytest.raises(TlsFilesError, match="KEY_VALUES_MISMATCH"):
        replace(files, key=other.key).context()


def test_a_file_that_is_no_pem_is_refused(files):
    files.key.write_bytes(b"\xff\xfe")
    with pytest.raises(TlsFilesError, match=r"station\.key is no PEM file"):
        files.context()
    files.key.write_text("nonsense")
    with pytest.raises(TlsFilesError, match="cannot be used"):
        files.context()


def test_a_key_with_a_password_is_refused_and_nobody_asked_for_it(tmp_path):
    files = make_certificate(tmp_path, password="secret")

    with pytest.raises(TlsFilesError, match="protected by a password") as refused:
        files.context()
    assert "openssl pkey" in refused.value.remedy


def test_without_tls_there_is_nothing_to_trust():
    assert trust("http://127.0.0.1:8000", "/nowhere") is None


def test_the_system_is_trusted_unless_told_otherwise():
    assert trust(URL).check_hostname


def test_a_given_certificate_is_trusted_for_the_names_in_it(files, monkeypatch):
    given = trust(URL, files.certificate)
    monkeypatch.setenv(CA_VARIABLE, str(files.certificate))
    from_environment = trust(URL)

    for context in (given, from_environment):
        assert context.check_hostname
        assert context.cert_store_stats()["x509"] == 1


def test_a_station_on_this_machine_is_known_by_its_first_certificate(files, tmp_path):
    other = make_certificate(tmp_path, name="authority")
    chain = files.certificate.read_text() + other.certificate.read_text()
    files.certificate.write_text(chain)
    me = os.getpid()
    write_runtime_file(
        RunningStation(
            url=URL,
            token="t",
            viewer_token="v",
            ui_url="",
            boot_id="b",
            pid=me,
            started=process_start(me),
            certificate=str(files.certificate),
        )
    )
    context = trust("https://localhost:8000")

    assert not context.check_hostname
    assert context.verify_mode is ssl.CERT_REQUIRED
    assert context.cert_store_stats()["x509"] == 1


def test_a_file_without_a_certificate_is_refused(files):
    with pytest.raises(TlsFilesError, match="holds no certificate"):
        trust(URL, files.key)
    with pytest.raises(TlsFilesError, match="nowhere cannot be read"):
        trust(URL, "/nowhere")
