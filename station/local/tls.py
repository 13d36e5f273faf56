"""TLS: certificate and key of a station, and the certificates that clients trust."""

import os
import ssl
from dataclasses import dataclass
from pathlib import Path

from station.core.errors import StationError
from station.local.station_locator import certificate_of

CA_VARIABLE = "STATION_CA"
"""Environment variable: path of the PEM file of certificates that clients trust."""
_END = "-----END CERTIFICATE-----"


class TlsFilesError(StationError, ValueError):
    """A certificate or a key cannot be used."""

    code = "tls_files"


@dataclass(frozen=True, slots=True)
class TlsFiles:
    """Certificate and key of a station.

    Attributes:
        certificate: PEM file with the certificate, followed by the intermediate
            certificates up to an authority, if there are any.
        key: PEM file with the certificate's private key, without a password.
    """

    certificate: Path
    key: Path

    def context(self) -> ssl.SSLContext:
        """Return the context of a server: TLS 1.2 or newer.

        Raises:
            TlsFilesError: A file cannot be read, or holds something else.
        """
        for what, path in (("certificate", self.certificate), ("key", self.key)):
            _read(path, what, "Correct api.tls, --tls-cert or --tls-key.")
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        try:
            # Without a function here, OpenSSL would ask for a password and wait.
            context.load_cert_chain(self.certificate, self.key, password=_refuse)
        except _EncryptedKeyError as error:
            raise TlsFilesError(
                f"The key {self.key} is protected by a password.",
                remedy="Give a key without one, e.g. of `openssl pkey -in KEY -out "
                "FILE`, in a file that only the station's user can read.",
            ) from error
        except ssl.SSLError as error:
            raise TlsFilesError(
                f"The certificate {self.certificate} and the key {self.key} cannot be "
                f"used: {error.reason or error}.",
                remedy="Give PEM files, and the key that belongs to the certificate.",
            ) from error
        return context


def trust(url: str, ca: str | os.PathLike[str] | None = None) -> ssl.SSLContext | None:
    """Return a context that checks a station's certificate; None for plain HTTP.

    For a station on this machine the client compares the certificate itself, and
    ignores the names in it. Every other station must have a certificate for the name in
    the URL.

    Args:
        url: The station.
        ca: PEM file with the certificates to trust: those of an authority, or the
            station's own. None takes the file in `STATION_CA`, or else the certificate
            of the station on this machine, or else the authorities of the system.

    Raises:
        TlsFilesError: A file cannot be read, or holds no certificate.
    """
    if not url.startswith("https:"):
        return None
    ca = ca or os.environ.get(CA_VARIABLE)
    if ca is not None:
        return _trust_only(_read(Path(ca), "certificate", "Correct --ca, or ca=."), ca)
    own = certificate_of(url)
    if not own:
        return ssl.create_default_context()
    text = _read(Path(own), "certificate", "Give --ca, or ca=.")
    # Only the first certificate is the station's. No name is checked here, so trusting
    # the authority as well would accept every server it has signed.
    context = _trust_only(text.partition(_END)[0] + _END + "\n", own)
    context.check_hostname = False
    return context


def _trust_only(text: str, path: str | os.PathLike[str]) -> ssl.SSLContext:
    """Return a context that trusts the certificates in a PEM text.

    Raises:
        TlsFilesError: The file has no certificate.
    """
    try:
        context = ssl.create_default_context(cadata=text)
    except (ssl.SSLError, ValueError) as error:
        raise TlsFilesError(
            f"{os.fspath(path)} holds no certificate.",
            remedy="Give a PEM file: -----BEGIN CERTIFICATE----- …",
        ) from error
    # Without this flag OpenSSL would trust only self-signed certificates by themselves.
    context.verify_flags |= ssl.VerifyFlags.VERIFY_X509_PARTIAL_CHAIN
    return context


class _EncryptedKeyError(Exception):
    """The key has a password."""


def _refuse() -> str:
    """Refuse to give the password of a key.

    Raises:
        _EncryptedKeyError: Always.
    """
    raise _EncryptedKeyError


def _read(path: Path, what: str, remedy: str) -> str:
    """Return the text of a PEM file.

    Raises:
        TlsFilesError: The file cannot be read.
    """
    try:
        return path.read_text(encoding="ascii")
    except OSError as error:
        raise TlsFilesError(
            f"The {what} {path} cannot be read: {error.strerror}.", remedy=remedy
        ) from error
    except UnicodeDecodeError as error:
        raise TlsFilesError(
            f"The {what} {path} is no PEM file.", remedy=remedy
        ) from error
