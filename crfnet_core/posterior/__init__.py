"""From evidence to an answer: a bank of responses, a prior over their families, and the posterior.

- `families`: the sources of responses.
- `responses`: the bank.
- `prior`: how likely each family is before the photograph is looked at.
- `factors`: how metadata shifts the prior.
- `evidence`: a network's reading of a photograph, as a likelihood of responses.
- `log_weights`: prior times evidence, in logarithms.
- `posterior`: the answer (the mean in log irradiance), its expected errors and its band.
- `verdict`: the posterior in one word.
"""

from crfnet_core.posterior.evidence import Evidence, independent_fraction
from crfnet_core.posterior.factors import metadata_factors
from crfnet_core.posterior.families import IN_CAMERA, UNUSUAL, Family, LikelyKind
from crfnet_core.posterior.posterior import Posterior
from crfnet_core.posterior.prior import Prior
from crfnet_core.posterior.responses import BANK_FILE, ResponseBank
from crfnet_core.posterior.verdict import Verdict

__all__ = ["BANK_FILE", "IN_CAMERA", "UNUSUAL", "Evidence", "Family", "LikelyKind", "Posterior", "Prior"]
__all__ += ["ResponseBank", "Verdict", "independent_fraction", "metadata_factors"]
