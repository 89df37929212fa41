"""The figures of the CRF-net paper (Li & Peers, CVMP 2017); E_lin is x 1e-2."""

from dataclasses import dataclass


@dataclass(frozen=True)
class PaperFigures:
    """Mean E_est and E_lin (x 1e-2) of one row of the paper."""

    estimation: float
    linearization: float


#: Sec. 4: all 201 curves on unseen photographs; also exposure 1.0 of Table 2, and the row without stress of Sec. 5.
OVERALL = PaperFigures(1.607, 2.089)
#: Sec. 5.6: gamma correction on the same photographs.
GAMMA = PaperFigures(3.132, 5.821)
#: The fractions of photographs on which the network wins against gamma 2.2.
WIN_RATE = PaperFigures(0.78, 0.86)

#: Tables 2 (exposure), 3 (noise) and 4 (blur), and Sec. 5.2 (resolution) and 5.3 (grayscale): by the name of our
#: condition.
STRESS = {
    "clean": OVERALL,
    "exposure 0.6": PaperFigures(1.621, 2.551),
    "exposure 0.8": PaperFigures(1.611, 2.331),
    "exposure 1.2": PaperFigures(1.647, 2.792),
    "exposure 1.4": PaperFigures(1.676, 2.999),
    "resolution 1x": OVERALL,
    "resolution 2x": PaperFigures(1.864, 2.701),
    "resolution 4x": PaperFigures(2.144, 3.029),
    "grayscale": PaperFigures(3.546, 4.028),
    "noise variance 0.5": PaperFigures(2.302, 3.359),
    "noise variance 1": PaperFigures(3.036, 4.419),
    "noise variance 2": PaperFigures(4.726, 9.128),
    "noise variance 4": PaperFigures(6.069, 48.20),
    "blur variance 1": PaperFigures(1.728, 2.821),
    "blur variance 2": PaperFigures(2.052, 3.398),
    "blur variance 4": PaperFigures(2.219, 3.594),
    "blur variance 8": PaperFigures(2.335, 3.544),
}

#: The estimator's name in tables.
PAPER = "the paper"
