"""Access rules of a router, as Zenoh's configuration. Zenoh drops messages that no rule allows, without an error."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from beatrix_zenoh.bus.transport import LARGEST_MESSAGE
from beatrix_zenoh.contract._generated import keys

ROOT = keys.KEYS["alive"].key.partition("/")[0]
EVERYTHING = (
    f"{ROOT}/**",
    keys.alive("*", "*"),
    keys.claim("*", "*", "*"),
    keys.seat("*", "*"),
    keys.program("*", "*"),
    keys.note("*", "*"),
    keys.lesson("*", "*"),
    keys.pending("*", "*"),
    keys.seats_router("*"),
)
"""All keys of BEATRIX; some are listed separately, because `**` matches no chunk that begins with @."""
MESSAGES = {
    "puts": ("put",),
    "queries": ("query",),
    "serves": ("declare_queryable", "reply"),
    "subscribes": ("declare_subscriber",),
    "tokens": ("liveliness_token",),
    "watches": ("liveliness_query", "declare_liveliness_subscriber"),
}
"""Zenoh's kinds of messages for each field of `Grant`."""
ALL_MESSAGES = (*(kind for kinds in MESSAGES.values() for kind in kinds), "delete")
DEPTH = 9
"""Largest number of chunks in the keys of BEATRIX, and a few more."""
LARGEST_REQUEST = 64 * 1024
"""Largest query (bytes); the router of a class drops larger ones."""


def below(root: str) -> tuple[str, ...]:
    """Return key expressions that include all keys below `root` with at most DEPTH chunks, and none with `**`.

    Zenoh 1.10 passes a declaration on to other routers, and a router ends with a stack overflow when it forgets a key
    of some thousand chunks, so a rule such as `beatrix/**` would let one seat end the router of the robots.
    """
    return tuple(root + "/*" * count for count in range(1, DEPTH - root.count("/")))


@dataclass(frozen=True)
class Grant:
    """Keys of the messages that one account may send; it may receive all messages of BEATRIX.

    A message whose key has wildcards passes only if one of these key expressions includes all keys that it matches.
    """

    account: str
    puts: tuple[str, ...] = ()
    queries: tuple[str, ...] = ()
    serves: tuple[str, ...] = ()
    subscribes: tuple[str, ...] = ()
    tokens: tuple[str, ...] = ()
    watches: tuple[str, ...] = ()


def access_control(grants: list[Grant], common_names: Mapping[str, str]) -> dict[str, object]:
    """Return Zenoh's section `access_control`: deny by default, a subject and a policy for each account.

    `common_names`: common name of the one valid certificate of each account. A certificate with another common name
    has no rights, even if the authority of the class has signed it.
    """
    rules = [_rule("receive", ALL_MESSAGES, EVERYTHING, "egress")]
    subjects: list[dict[str, object]] = []
    policies: list[dict[str, object]] = []
    for grant in grants:
        own = list(_rules(grant))
        rules += own
        subjects.append({"id": grant.account, "cert_common_names": [common_names[grant.account]]})
        policies.append({"subjects": [grant.account], "rules": ["receive", *(rule["id"] for rule in own)]})
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": subjects,
        "policies": policies,
    }


def _rules(grant: Grant) -> Iterator[dict[str, object]]:
    for field, kinds in MESSAGES.items():
        expressions: tuple[str, ...] = getattr(grant, field)
        if expressions:  # Zenoh refuses empty lists
            yield _rule(f"{grant.account} {field}", kinds, expressions)


def _rule(name: str, kinds: tuple[str, ...], expressions: tuple[str, ...], *flows: str) -> dict[str, object]:
    return {
        "id": name,
        "permission": "allow",
        "messages": kinds,
        "flows": flows or ("ingress",),
        "key_exprs": expressions,
    }


def downsampling(rates: Mapping[str, float]) -> list[dict[str, object]]:
    """Return Zenoh's section `downsampling`: the largest rate (Hz) of each key's publications from each session."""
    # All keys that match one rule share its rate, so each key needs its own rule. Zenoh looks for the rule of each
    # message, at the egress once for each receiver: 30 seats that watch 30 robots would double the router's load.
    rules = [{"key_expr": key, "freq": rate} for key, rate in rates.items()]
    return [{"id": "rates", "messages": ["put"], "flows": ["ingress"], "rules": rules}] if rules else []


def low_pass_filter() -> list[dict[str, object]]:
    """Return Zenoh's section `low_pass_filter`: the largest messages that a session may send."""
    requests = {"messages": ["query"], "size_limit": LARGEST_REQUEST}
    messages = {"messages": ["put", "delete", "reply"], "size_limit": LARGEST_MESSAGE}
    return [
        {"id": name, "flows": ["ingress"], "key_exprs": ["**", *EVERYTHING[1:]], **rule}
        for name, rule in {"requests": requests, "messages": messages}.items()
    ]
