"""Certificates of a class: its own authority signs those of its router; those of accounts sign themselves.

The router lists the certificates of the accounts one by one, so TLS itself refuses a card that was replaced or removed.
"""

from __future__ import annotations

import datetime as dt
import ipaddress

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from beatrix_zenoh.account import RENEW_DAYS
from beatrix_zenoh.bus.credentials import Identity

BEGIN = dt.datetime(1970, 1, 1, tzinfo=dt.UTC)
"""Start of the validity of all certificates: where clocks without a battery begin, so no clock is too early."""
AUTHORITY_DAYS, ACCOUNT_DAYS = 3650, 400
"""Validity of the authority's certificate (ten years) and of an account's (a school year and its holidays)."""
LOOPBACK = ("127.0.0.1", "localhost")


class Authority:
    """The key that signs the certificates of one class."""

    def __init__(self, certificate: x509.Certificate, key: ec.EllipticCurvePrivateKey) -> None:
        self._certificate, self._key = certificate, key

    @classmethod
    def make(cls, class_name: str) -> Authority:
        """Make a new authority; it does not accept certificates of an earlier one."""
        key = ec.generate_private_key(ec.SECP256R1())
        name = _name(f"BEATRIX class {class_name}")
        builder = _builder(name, name, key, AUTHORITY_DAYS)
        builder = builder.add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
        return cls(builder.sign(key, hashes.SHA256()), key)

    @classmethod
    def read(cls, text: str) -> Authority:
        """Parse the text of an authority's file; raises ValueError if it is invalid."""
        key = serialization.load_pem_private_key(text.encode(), password=None)
        if not isinstance(key, ec.EllipticCurvePrivateKey):
            raise ValueError("it has no elliptic-curve key")  # noqa: TRY004  # the content of a file, not an argument
        return cls(x509.load_pem_x509_certificate(text.encode()), key)

    @property
    def text(self) -> str:
        """The content of its file: certificate and private key (PEM)."""
        return self.certificate + _key_text(self._key)

    @property
    def certificate(self) -> str:
        """The authority's own certificate (PEM)."""
        return _text(self._certificate)

    def issue(self, common_name: str, addresses: tuple[str, ...], *, days: int = ACCOUNT_DAYS) -> Identity:
        """Issue a certificate, with a new key, for a router at these addresses."""
        key = ec.generate_private_key(ec.SECP256R1())
        builder = _builder(_name(common_name), self._certificate.subject, key, days)
        usages = [ExtendedKeyUsageOID.CLIENT_AUTH, ExtendedKeyUsageOID.SERVER_AUTH]
        alternatives = [_alternative(address) for address in (*addresses, *LOOPBACK)]
        builder = builder.add_extension(x509.SubjectAlternativeName(alternatives), critical=False)
        signed = _leaf(builder, usages).sign(self._key, hashes.SHA256())
        return Identity(self.certificate, _text(signed), _key_text(key))

    def signed(self, certificate: str) -> bool:
        """Return whether this authority has signed a certificate (PEM) that is valid for more than RENEW_DAYS."""
        return _is_current(certificate, self._certificate)


def account(
    common_name: str, authority: str, *, begin: dt.datetime = BEGIN, days: int = ACCOUNT_DAYS
) -> Identity:
    """Make the certificate of an account, with a new key; it trusts routers that `authority` (PEM) has signed."""
    key = ec.generate_private_key(ec.SECP256R1())
    name = _name(common_name)
    builder = _leaf(_builder(name, name, key, days, begin), [ExtendedKeyUsageOID.CLIENT_AUTH])
    return Identity(authority, _text(builder.sign(key, hashes.SHA256())), _key_text(key))


def is_current(certificate: str) -> bool:
    """Return whether the certificate (PEM) of an account has signed itself and is valid for more than RENEW_DAYS."""
    return _is_current(certificate, None)


def _is_current(certificate: str, issuer: x509.Certificate | None) -> bool:
    try:
        read = x509.load_pem_x509_certificate(certificate.encode())
        read.verify_directly_issued_by(issuer or read)
    except Exception:  # noqa: BLE001  # cryptography raises many kinds of errors for foreign certificates
        return False
    return read.not_valid_after_utc > _in_days(RENEW_DAYS)


def common_name(certificate: str) -> str:
    """Return the common name in a certificate (PEM)."""
    subject = x509.load_pem_x509_certificate(certificate.encode()).subject
    return str(subject.get_attributes_for_oid(NameOID.COMMON_NAME)[0].value)


def expiry(certificate: str) -> dt.date:
    """Return the last day on which a certificate (PEM) is valid."""
    return x509.load_pem_x509_certificate(certificate.encode()).not_valid_after_utc.date()


def _builder(
    subject: x509.Name,
    issuer: x509.Name,
    key: ec.EllipticCurvePrivateKey,
    days: int,
    begin: dt.datetime = BEGIN,
) -> x509.CertificateBuilder:
    builder = x509.CertificateBuilder(issuer, subject, key.public_key(), x509.random_serial_number())
    return builder.not_valid_before(begin).not_valid_after(_in_days(days))


def _leaf(builder: x509.CertificateBuilder, usages: list[x509.ObjectIdentifier]) -> x509.CertificateBuilder:
    """Return the builder of a certificate that signs no other, for these usages."""
    builder = builder.add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
    return builder.add_extension(x509.ExtendedKeyUsage(usages), critical=False)


def _in_days(days: int) -> dt.datetime:
    return dt.datetime.now(dt.UTC) + dt.timedelta(days=days)


def _name(text: str) -> x509.Name:
    return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, text)])


def _alternative(address: str) -> x509.GeneralName:
    """Return an address in the form that clients compare: an IP address, or a name."""
    host = address.strip("[]")
    try:
        return x509.IPAddress(ipaddress.ip_address(host))
    except ValueError:
        return x509.DNSName(host)


def _text(certificate: x509.Certificate) -> str:
    return certificate.public_bytes(serialization.Encoding.PEM).decode()


def _key_text(key: ec.EllipticCurvePrivateKey) -> str:
    encoding, form = serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8
    return key.private_bytes(encoding, form, serialization.NoEncryption()).decode()
