"""The prior: the probability of each family of responses before a photograph is seen."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

from crfnet_core.errors import PriorError, check_kinds
from crfnet_core.files import read_json
from crfnet_core.posterior.families import Family
from crfnet_core.types import is_number

#: The packaged priors, and the one that is used unless another is asked for.
PRIORS = Path(__file__).parents[1] / "data" / "priors"
DEFAULT_PRIOR = "camera"


@dataclass(frozen=True)
class Prior:
    """Shares of the families (Eq. 22 of docs/METHOD.md), and how much a photograph's evidence counts against them."""

    name: str  # its name in reports
    shares: Mapping[Family, float]  # family -> share; at least 0, and their sum is 1
    #: Exponent on the likelihood of ordinary responses, in [0, 1]. Evidence is learned from simulated photographs; on
    #: real ones it is worth less, and this is how much.
    evidence: float
    #: Share of ordinary photographs that look to the network as unusual pictures do, in [0, 1). The pixels alone never
    #: raise the odds of an unusual family by more than 1 / lookalikes; 0 sets no bound.
    lookalikes: float = 0.0
    #: Odds that a picture has a plain response (`ResponseBank.plain`), if neither its file nor the user names a camera.
    plain: float = 0.0

    @classmethod
    def load(cls, wanted: str | Path = DEFAULT_PRIOR) -> Self:
        """Return a packaged prior by its name, or the one in a JSON file.

        The file holds `{"shares": {"phone": 0.5, ...}, "evidence": 0.15, "lookalikes": 0.03}`; families that it leaves
        out have no share, and "lookalikes" and "plain" are 0 unless they are given. Raise PriorError if there is no
        such prior, or the file does not describe one.
        """
        check_kinds(prior=(wanted, str | Path))
        path = Path(wanted)
        try:
            path = packaged if (packaged := PRIORS / f"{wanted}.json").is_file() else path
            entries = read_json(path)
        except OSError as problem:
            names = ", ".join(packaged_priors())
            raise PriorError("no_prior", name=wanted, reason=problem.strerror, names=names) from None
        except ValueError:
            raise PriorError("prior_not_json", path=path) from None
        return cls._from_entries(path, entries)

    @classmethod
    def _from_entries(cls, path: Path, entries: object) -> Self:
        """Return the prior that a JSON file describes; a PriorError if it describes none."""
        if not isinstance(entries, dict) or set(entries) - {"lookalikes", "plain"} != {"shares", "evidence"}:
            raise PriorError("bad_prior", path=path)
        shares, evidence = entries["shares"], entries["evidence"]
        lookalikes, plain = (entries.get(name, 0.0) for name in ("lookalikes", "plain"))
        if not isinstance(shares, dict) or not set(shares) <= set(Family):
            raise PriorError("bad_prior_families", path=path, families=", ".join(Family))
        numbers = [*shares.values(), evidence, lookalikes, plain]
        if not all(is_number(number, least=0, most=1) for number in numbers) or not any(numbers[:-3]):
            raise PriorError("bad_prior_values", path=path)
        if lookalikes == 1:
            raise PriorError("bad_lookalikes", path=path)
        total = sum(shares.values())
        scaled = {Family(name): share / total for name, share in shares.items()}
        return cls(path.stem, scaled, evidence, lookalikes, plain)

    def reweighted(self, factors: Mapping[Family, float]) -> Self:
        """Return the prior after evidence on the families: shares times factors, scaled to a sum of 1."""
        shares = {family: share * factors.get(family, 1.0) for family, share in self.shares.items()}
        total = sum(shares.values())
        return replace(self, shares={family: share / total for family, share in shares.items()})


def packaged_priors() -> list[str]:
    """Return the names of the packaged priors, sorted."""
    return sorted(path.stem for path in PRIORS.glob("*.json"))
