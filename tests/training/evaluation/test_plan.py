from collections import Counter

from training.evaluation.plan import CLEAN, CONDITIONS, Condition, balanced, clean_photographs, stress_photographs
from training.synthesis.camera import Capture


def test_the_five_exposures_are_shared_out_equally():
    cells = balanced(range(20), range(201), count=10_000)
    assert Counter(factor for *_, factor in cells) == {0.6: 804, 0.8: 804, 1.0: 804, 1.2: 804, 1.4: 804}
    for position in (0, 1):
        shares = Counter((cell[position], cell[2]) for cell in cells)
        assert max(shares.values()) - min(shares.values()) <= 2


def test_a_smaller_part_is_the_beginning_of_a_larger_one():
    large = balanced(range(20), range(201), count=100)
    assert balanced(range(20), range(201), count=40) == large[:40]


def test_every_photograph_has_a_label_of_its_own():
    photographs = stress_photographs(range(5), (5,), range(13), count=5)
    labels = {photograph.label for photograph in photographs + clean_photographs(range(5), range(13), count=65)}
    same = 1  # of the 5 clean ones of the protocol "paper", the one that P0 takes at exposure 1 as well
    assert len(labels) == len(photographs) + 65 - same
    assert "scene 1, curve 2, exposure 0.6, clean" in {
        photograph.label for photograph in clean_photographs([1], [2], count=1)
    }


def test_every_condition_has_the_same_photographs_and_resolutions_those_of_originals():
    photographs = stress_photographs(range(20), (20, 21), range(201), count=40)
    assert len(photographs) == 40 * len(CONDITIONS) == 40 * 25
    cells = {(photograph.scene, photograph.curve) for photograph in photographs if not photograph.condition.averaged}
    assert len(cells) == 40
    assert {photograph.scene for photograph in photographs if photograph.condition.averaged} == {20, 21}
    assert [condition.averaged for condition in CONDITIONS if condition.averaged] == [4, 2, 1]
    assert len(stress_photographs(range(20), (), range(201), count=40)) == 40 * 22  # no resolutions without originals


def test_conditions_that_differ_behind_the_lens_share_their_light():
    noisy, dark = Condition("noise", noise=2.0), Condition("dark", factor=0.6)
    assert noisy.light == dark.light == CLEAN.light
    assert Condition("blur", blur=2.0).light != CLEAN.light


def test_noise_comes_before_the_response():
    assert Condition("noise", noise=4.0).capture == Capture(read_noise=2 / 255)
    assert Condition("JPEG", jpeg_quality=75, blur=2.0).capture == Capture(jpeg_quality=75)


def test_all_photographs_are_every_scene_with_every_curve_also_where_turns_repeat():
    cells = balanced(range(6), range(4), count=10_000)
    assert len(cells) == len({cell[:2] for cell in cells}) == 24
