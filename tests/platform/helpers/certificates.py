"""Certificates for tests, made when they are needed."""

import datetime as dt
import ipaddress
from pathlib import Path
from typing import NamedTuple

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID

DAY = dt.timedelta(days=1)
# Python 3.13 and newer refuse an authority that does not say that it signs, as RFC 5280 asks of it.
SIGNS = x509.KeyUsage(
    key_cert_sign=True,
    crl_sign=True,
    digital_signature=False,
    content_commitment=False,
    key_encipherment=False,
    data_encipherment=False,
    key_agreement=False,
    encipher_only=False,
    decipher_only=False,
)


class Pair(NamedTuple):
    """Files of a certificate and its key."""

    cert: Path
    key: Path


class Authority:
    """Signs certificates for this machine.

    Args:
        folder: Where files go.
        name: Of the authority.
    """

    def __init__(self, folder: Path, name: str) -> None:
        self._folder, self._name = folder, x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)])
        self._key = ec.generate_private_key(ec.SECP256R1())
        basic = x509.BasicConstraints(ca=True, path_length=None)
        certificate = self._about(self._name, self._key.public_key(), DAY)
        certificate = certificate.add_extension(basic, critical=True).add_extension(SIGNS, critical=True)
        self.path = self._write(f"{name}.pem", certificate)

    def sign(self, name: str, *, valid: dt.timedelta = DAY) -> Pair:
        """Make a certificate of this machine, valid until some time from now; before now, it has expired."""
        key = ec.generate_private_key(ec.SECP256R1())
        subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)])
        hosts = x509.SubjectAlternativeName(
            [x509.DNSName("localhost"), x509.IPAddress(ipaddress.ip_address("127.0.0.1"))]
        )
        certificate = self._about(subject, key.public_key(), valid).add_extension(hosts, critical=False)
        where = self._folder / f"{name}.key"
        where.write_bytes(
            key.private_bytes(
                serialization.Encoding.PEM,
                serialization.PrivateFormat.PKCS8,
                serialization.NoEncryption(),
            )
        )
        return Pair(self._write(f"{name}.pem", certificate), where)

    def _about(
        self, subject: x509.Name, key: ec.EllipticCurvePublicKey, valid: dt.timedelta
    ) -> x509.CertificateBuilder:
        now = dt.datetime.now(dt.UTC)
        builder = x509.CertificateBuilder().issuer_name(self._name).subject_name(subject).public_key(key)
        builder = builder.serial_number(x509.random_serial_number())
        builder = builder.not_valid_before(now - 10 * DAY).not_valid_after(now + valid)
        signer = x509.AuthorityKeyIdentifier.from_issuer_public_key(self._key.public_key())
        own = x509.SubjectKeyIdentifier.from_public_key(key)
        return builder.add_extension(own, critical=False).add_extension(signer, critical=False)

    def _write(self, name: str, certificate: x509.CertificateBuilder) -> Path:
        signed = certificate.sign(self._key, hashes.SHA256())
        path = self._folder / name
        path.write_bytes(signed.public_bytes(serialization.Encoding.PEM))
        return path
