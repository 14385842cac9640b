"""How often one address may fail to sign in."""

import math
import time
from ipaddress import IPv6Address, ip_address

from limits import RateLimitItemPerMinute
from limits.storage import MemoryStorage
from limits.strategies import MovingWindowRateLimiter

from treestroke.api.errors import Refusal

MOST_A_MINUTE = 10
_PREFIX_BITS = 64
"""Of an IPv6 address, what belongs to one network, whose hosts take any address in it."""


class FailedSignIns:
    """Counts, in this process, who failed to sign in during the last minute."""

    def __init__(self) -> None:
        self._most = RateLimitItemPerMinute(MOST_A_MINUTE)
        self._failed = MovingWindowRateLimiter(MemoryStorage())

    def check(self, address: str) -> None:
        """Check that an address may try to sign in.

        Raises
        ------
        Refusal
            It failed too often.
        """
        network = _network(address)
        if not self._failed.test(self._most, network):
            seconds = math.ceil(self._failed.get_window_stats(self._most, network).reset_time - time.time())
            detail = f"too many keys were wrong; try again in {max(seconds, 1)} seconds"
            raise Refusal("rate_limited", detail, headers={"Retry-After": str(max(seconds, 1))})

    def count(self, address: str) -> None:
        """Count a failure."""
        self._failed.hit(self._most, _network(address))


def _network(address: str) -> str:
    """Return what failures of an address are counted under: of IPv6, all addresses of its network."""
    try:
        found = ip_address(address)
    except ValueError:
        return address
    if isinstance(found, IPv6Address):
        return str(int(found) >> (128 - _PREFIX_BITS))
    return address
