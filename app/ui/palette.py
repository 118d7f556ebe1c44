"""Colours of the page, the same in the scene, in the panels and in the legend."""

from backend.pipeline.values import Phase

Rgb = tuple[int, int, int]

BRAND: Rgb = (24, 100, 171)
LINK: Rgb = (34, 139, 230)
ANCHOR = "var(--mantine-color-anchor)"
"""CSS of the page's links, readable on light and dark alike."""
FLOOR: Rgb = (246, 247, 249)
FLOOR_CELL: Rgb = (228, 231, 235)
FLOOR_SECTION: Rgb = (206, 212, 218)
DARK_FLOOR: Rgb = (34, 37, 42)
DARK_FLOOR_CELL: Rgb = (46, 50, 56)
DARK_FLOOR_SECTION: Rgb = (64, 69, 77)
BELT: Rgb = (104, 114, 128)
BELT_ARROW: Rgb = (255, 255, 255)
TRAY: Rgb = (52, 60, 74)
BASE: Rgb = (150, 158, 170)
SLAB: Rgb = (176, 137, 104)
PREDICTION: Rgb = (112, 72, 232)
PREDICTION_BOUNDS: Rgb = (177, 151, 252)
PLAN: Rgb = (28, 126, 214)
SEED_PLAN: Rgb = (245, 159, 0)
TRAIL: Rgb = (12, 166, 120)
REACH: Rgb = (24, 100, 171)
REACH_EDGE: Rgb = (116, 192, 252)
PICKED: Rgb = (214, 51, 108)
RANKS: tuple[Rgb, ...] = ((43, 138, 62), (130, 201, 30), (252, 196, 25), (253, 126, 20))
"""Best to worst of the shortlist."""
SERIES: tuple[Rgb, ...] = (
    (28, 126, 214),
    (12, 166, 120),
    (245, 159, 0),
    (214, 51, 108),
    (112, 72, 232),
    (134, 142, 150),
)
"""Told apart in one plot: joints, rooms."""
GOOD: Rgb = (43, 138, 62)
BAD: Rgb = (201, 42, 42)
QUIET: Rgb = (134, 142, 150)
CYCLE: Rgb = (77, 171, 247)
PHASES: dict[Phase, Rgb] = {
    "watch": (134, 142, 150),
    "move": (28, 126, 214),
    "approach": (230, 119, 0),
    "close": (214, 51, 108),
    "lift": (55, 178, 77),
    "hold": (43, 138, 62),
    "done": (43, 138, 62),
}


def css(color: Rgb) -> str:
    """As CSS writes it."""
    return "#{:02x}{:02x}{:02x}".format(*color)


def rank_color(rank: int, count: int) -> Rgb:
    """Between the first and last of ``RANKS`` for rank 0 .. count - 1."""
    return blend(RANKS, rank / max(count - 1, 1))


def blend(colors: tuple[Rgb, ...], share: float) -> Rgb:
    """The colour at ``share`` in 0..1 of the way through ``colors``."""
    place = share * (len(colors) - 1)
    i = min(int(place), len(colors) - 2)
    red, green, blue = (round(a + (b - a) * (place - i)) for a, b in zip(colors[i], colors[i + 1], strict=True))
    return red, green, blue
