"""How often one address may come with a wrong key: to sign in by it, or to ask with it."""

from contextlib import suppress
from ipaddress import IPv6Address, ip_address

from treestroke.api.errors import Refusal
from treestroke.api.request_counts import Rate, RateLimited, RequestCounts

MOST_A_MINUTE = 10
FAILED_SIGN_INS, FAILED_KEYS = (Rate(name, MOST_A_MINUTE, 60) for name in ("failed sign-ins", "failed keys"))
_PREFIX_BITS = 64
"""Of an IPv6 address, what belongs to one network, whose hosts take any address in it."""


class Failures:
    """Counts failures of one kind by address, where the requests of all web processes are counted."""

    def __init__(self, counts: RequestCounts, rate: Rate) -> None:
        self._counts, self._rate = counts, rate

    async def check(self, address: str) -> None:
        """Check that an address may fail once more.

        Raises
        ------
        Refusal
            It failed too often.
        """
        standing = await self._counts.standing(self._rate, _network(address))
        if not standing.remaining:
            retry_s = str(standing.more_in_s)
            detail = f"too many keys were wrong; try again in {retry_s} seconds"
            raise Refusal("rate_limited", detail, headers={"Retry-After": retry_s})

    async def count(self, address: str) -> None:
        """Count a failure."""
        with suppress(RateLimited):
            await self._counts.take(self._rate, _network(address))


def _network(address: str) -> str:
    """Return what failures of an address are counted under: of IPv6, all addresses of its network."""
    try:
        found = ip_address(address)
    except ValueError:
        return address
    if isinstance(found, IPv6Address):
        return str(int(found) >> (128 - _PREFIX_BITS))
    return address
