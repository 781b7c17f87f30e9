"""`python -m docs.gallery`: run the shipped cases without a picture, and keep what `hockle plot` draws of them."""

from __future__ import annotations

import tempfile
from pathlib import Path

from PIL import Image

from hockle.cli import main
from service.cases import shipped_cases

PICTURES = Path(__file__).parent / "pictures" / "cases"
SIZE, COLOURS = (1000, 1000), 64
"""As large as a page is wide; few colours, for small files."""


def draw(name: str, folder: Path) -> None:
    """Run a case and keep its picture."""
    dataset = folder / f"{name}.nc"
    if main(["run", name, "-o", str(dataset)]) or main(["plot", str(dataset)]):
        raise SystemExit(f"{name}: not drawn")
    shapes = folder / f"{name}-snapshots.png"
    if shapes.exists():
        with Image.open(shapes) as picture:
            small = picture.convert("RGB")
        small.thumbnail(SIZE)
        small.quantize(COLOURS).save(PICTURES / f"{name}.png", optimize=True)


if __name__ == "__main__":
    PICTURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        for case in shipped_cases():
            if not (PICTURES / f"{case}.png").exists():
                draw(case, Path(folder))
