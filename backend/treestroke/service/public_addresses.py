"""Which addresses of the network are public, so that nobody reaches by a webhook what only this machine reaches."""

from ipaddress import IPv4Address, IPv6Address, IPv6Network, ip_address

_UNICAST = IPv6Network("2000::/3")
"""All that was ever given out; what lies beyond includes forms that wrap an IPv4 address."""
_TRANSLATED = IPv6Network("64:ff9b::/96")


def is_public(address: str) -> bool:
    """Tell whether an address is one that everybody in the internet reaches, and that belongs to one machine.

    An IPv4 address within an IPv6 one (mapped, translated by NAT64, 6to4) counts as itself.
    """
    ip = ip_address(address.partition("%")[0])
    if isinstance(ip, IPv6Address):
        within = ip.ipv4_mapped or ip.sixtofour or (IPv4Address(ip.packed[-4:]) if ip in _TRANSLATED else None)
        if within is None and ip not in _UNICAST:
            return False
        ip = within or ip
    return ip.is_global and not ip.is_multicast
