"""The figures of the CRF-net paper (Li & Peers, CVMP 2017); E_lin is x 1e-2."""

from dataclasses import dataclass
from pathlib import Path

from training.data.scenes import table_rows


@dataclass(frozen=True)
class PaperFigures:
    """Mean E_est and E_lin (x 1e-2) of one row of the paper."""

    estimation: float
    linearization: float


#: Name of our condition -> the figures in paper.csv beside this module.
STRESS = {
    row["condition"]: PaperFigures(float(row["E_est"]), float(row["E_lin"]))
    for row in table_rows(Path(__file__).with_name("paper.csv"))
}

#: Sec. 4: all 201 curves on unseen photographs; Sec. 5.6: gamma correction on the same photographs.
OVERALL, GAMMA = STRESS["clean"], PaperFigures(3.132, 5.821)

#: The fractions of photographs on which the network wins against gamma 2.2.
WIN_RATE = PaperFigures(0.78, 0.86)

#: The estimator's name in tables.
PAPER = "the paper"
