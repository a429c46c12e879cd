"""Which faults befall a cluster, and when: drawn from a seed."""

import dataclasses
import random

MEAN_GAP = 0.5  # s


@dataclasses.dataclass(frozen=True)
class Kind:
    weight: float
    shortest: float  # s that it lasts, log-uniform; 0: an instant
    longest: float


# "master", "render" and "editor" are one each; "node" is one of several.
KINDS = {
    ("kill", "node"): Kind(4, 0.05, 3.0),
    ("leave", "node"): Kind(2, 0.05, 3.0),  # SIGTERM: it hands back what it holds
    ("stop", "node"): Kind(3, 0.1, 10.0),
    ("hold", "node"): Kind(3, 0.1, 5.0),
    ("forget", "node"): Kind(2, 0.0, 0.0),
    ("cut", "node"): Kind(3, 0.0, 0.0),
    ("join", "node"): Kind(1, 1.0, 8.0),  # one more
    ("kill", "master"): Kind(1.5, 0.05, 2.0),
    ("stop", "master"): Kind(1, 0.1, 3.0),
    ("leave", "master"): Kind(0.5, 0.05, 2.0),
    ("kill", "render"): Kind(1.5, 0.0, 0.0),
    ("stop", "render"): Kind(1, 0.1, 5.0),
    ("hold", "render"): Kind(1, 0.1, 5.0),
    ("cut", "render"): Kind(1.5, 0.0, 0.0),
    ("hold", "editor"): Kind(1, 0.1, 5.0),
    ("cut", "editor"): Kind(1.5, 0.0, 0.0),
    ("forget", "editor"): Kind(1, 0.0, 0.0),
}


@dataclasses.dataclass(frozen=True)
class Fault:
    at: float  # s from the start
    what: str
    target: str  # a role, or the name of a node
    seconds: float

    def __str__(self):
        lasting = f" for {self.seconds:.2f} s" if self.seconds else ""
        return f"{self.what} {self.target}{lasting}"


@dataclasses.dataclass(frozen=True)
class Link:
    """Of the line between a peer and the master."""

    rate: float  # bits per second
    latency: float  # s
    jitter: float  # s, at most


def draw_links(seed, names):
    """The line of each peer, by name."""
    draw = random.Random(f"links {seed}")
    return {name: Link(10 ** draw.uniform(7.5, 9), 10 ** draw.uniform(-4, -1.5), 10 ** draw.uniform(-4, -2)) for name in names}


def draw_faults(seed, seconds, nodes, client, mean_gap=MEAN_GAP):
    """In the order of time. client: "render" or "editor", which is there; mean_gap: s between the beginnings of two faults, which
    may overlap, also those of one process or line."""
    draw = random.Random(f"faults of {client} {seed}")
    kinds = {fault: kind for fault, kind in KINDS.items() if fault[1] in ("node", "master", client)}
    faults, at = [], 0.0
    while True:
        at += draw.expovariate(1 / mean_gap)
        if at > seconds:
            return faults
        (what, target), kind = draw.choices(list(kinds.items()), [kind.weight for kind in kinds.values()])[0]
        lasts = kind.shortest * (kind.longest / kind.shortest) ** draw.random() if kind.longest else 0.0
        faults.append(Fault(at, what, draw.choice(nodes) if target == "node" and what != "join" else target, lasts))
