from dataclasses import replace

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the train extra")
pytest.importorskip("onnxscript", reason="training needs the train extra")

from crfnet_core.network import ResponseNetwork
from crfnet_core.response.emor import EmorBasis
from training.crfnet2017 import train as command
from training.crfnet2017.export import fit_worth, fold_normalization, load_network
from training.crfnet2017.network import CRFNet
from training.crfnet2017.recipes import RECIPES, Recipe, learning_rate, make_optimizer
from training.crfnet2017.train import RunConfig, StageTask, Trainer, start_from, train
from training.crfnet2017.windows import draw_windows
from training.export.model_folder import PARITY, assert_parity, write_config, write_golden
from training.export.onnx_graph import WINDOWED, export_onnx, rounded
from training.provenance import read_run
from training.state import TrainingState, moving_average

REGRESSION = RunConfig("regress", Recipe(steps=2, batch=2, mixed=False, averaged_steps=2.0))


@pytest.fixture(scope="module")
def validation(scenes):
    """Held-out windows."""
    return draw_windows(scenes, 3, seed=7)


@pytest.fixture(scope="module")
def run(scenes, validation, tmp_path_factory):
    """A run of two steps that was not stopped."""
    folder = tmp_path_factory.mktemp("whole")
    train(scenes, validation, folder, REGRESSION, digest="data")
    return folder


def states(folder):
    """The average and the moving weights of the last checkpoint of a run."""
    state = torch.load(folder / "last.pt", weights_only=True)
    return state["network"], state["moving"]


def equal(first, second):
    return first.keys() == second.keys() and all(torch.equal(first[name], second[name]) for name in first)


def test_the_stages_measure_what_they_say():
    curves = EmorBasis.load().reconstruct(np.eye(3, 11))
    curves = torch.from_numpy(curves)
    classify, regress = (StageTask(stage, curves, squared=False) for stage in ("classify", "regress"))
    classes = torch.tensor([0, 2])
    assert (classify.outputs, regress.outputs) == (3, 11)
    assert classify.figures(torch.eye(3)[[0, 1]], classes).tolist() == [1, 0]
    assert float(classify.loss(torch.zeros(2, 3), classes)) == pytest.approx(np.log(3))
    assert regress.figures(torch.zeros(2, 11), classes).tolist() == pytest.approx([1, 1], abs=1e-5)
    assert float(regress.loss(torch.zeros(2, 11), classes)) == pytest.approx(1, abs=1e-5)
    halved = StageTask("regress", curves, squared=True)
    assert float(halved.loss(torch.zeros(2, 11), classes)) == pytest.approx(0.5, abs=1e-5)
    assert classify.is_better(0.2, [0.1])
    assert not regress.is_better(0.2, [0.1])


def test_the_papers_recipe_is_the_published_one():
    classify, regress = RECIPES["paper"]["classify"], RECIPES["paper"]["regress"]
    assert (classify.steps, regress.steps) == (2_000_000, 25_000)
    steps = (0, 499_999, 500_000, 1_999_999)
    assert [learning_rate(classify, step) for step in steps] == pytest.approx([1e-2, 1e-2, 1e-3, 1e-5])
    assert [learning_rate(regress, step) for step in (0, 19_999, 24_999)] == pytest.approx([1e-4, 1e-4, 1e-5])
    optimizer, _ = make_optimizer(CRFNet(), regress)
    assert isinstance(optimizer, torch.optim.SGD)
    assert [(group["momentum"], group["weight_decay"]) for group in optimizer.param_groups] == [(0.9, 0.0005)] * 2


def test_the_default_learning_rate_is_one_cycle():
    recipe = Recipe(steps=100)
    assert [learning_rate(recipe, step) for step in (0, 10, 55)] == pytest.approx([5e-5, 1e-3, 5e-4])


def test_the_first_stage_learns(scenes):
    config = RunConfig("classify", Recipe(steps=3, batch=2, learning_rate=2e-3, head_factor=0.01))
    task = StageTask("classify", scenes.curves, squared=False)
    torch.manual_seed(0)
    network = CRFNet(task.outputs)
    averaged = moving_average(network, config.recipe.averaged_steps)
    state = TrainingState(network, averaged, *make_optimizer(network, config.recipe))
    batch = draw_windows(scenes, 2, seed=5)
    trainer = Trainer(config, task, state, scenes, batch)
    losses = [float(trainer.step(batch)) for _ in range(3)]
    assert losses[0] == pytest.approx(np.log(4), abs=1e-3)
    assert min(losses) < 0.8 * losses[0]


def test_a_stopped_run_goes_on_as_if_it_had_not_stopped(scenes, validation, run, tmp_path, monkeypatch):
    def interrupted(trainer, batch):
        if trainer.state.done:
            raise KeyboardInterrupt
        return step(trainer, batch)

    step = Trainer.step
    monkeypatch.setattr(command, "CHECKPOINT_SECONDS", 0)
    monkeypatch.setattr(Trainer, "step", interrupted)
    with pytest.raises(KeyboardInterrupt):
        train(scenes, validation, tmp_path, REGRESSION, digest="data")
    monkeypatch.setattr(Trainer, "step", step)
    first, before = states(tmp_path)
    assert train(scenes, validation, tmp_path, REGRESSION, digest="data").done == 2
    averaged, moving = states(tmp_path)
    assert equal(averaged, states(run)[0])
    assert equal(first, before)
    for name, _ in CRFNet().named_parameters():
        assert torch.allclose(averaged[name], (moving[name] + before[name]) / 2, rtol=1e-5, atol=1e-7)
    assert not torch.equal(averaged["head.weight"], moving["head.weight"])


def test_the_command_trains_on_a_processor(scenes, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(command, "read_splits", lambda data, device: {"train": scenes, "validation": scenes})
    monkeypatch.setattr(command, "training_digest", lambda data: "data")
    monkeypatch.setattr(command, "VALIDATION_WINDOWS", 2)
    monkeypatch.setattr(command, "RECIPES", {"default": {"regress": replace(REGRESSION.recipe, augmented=True)}})
    options = ["train", "--data", "data", "--stage", "regress", "--device", "cpu", "--steps", "1", "--run"]
    monkeypatch.setattr("sys.argv", [*options, str(tmp_path)])
    command.main()
    assert capsys.readouterr().out.startswith("step,train_loss,validation\n1,")
    assert read_run(tmp_path)["recipe"]["recipe"]["batch"] == 2
    assert load_network(tmp_path).network.head.out_features == 11


def test_another_configuration_is_refused(scenes, validation, run):
    with pytest.raises(SystemExit, match="another seed"):
        train(scenes, validation, run, replace(REGRESSION, seed=2), digest="data")


def test_the_second_stage_takes_all_but_the_head(tmp_path):
    first, second = CRFNet(3), CRFNet()
    torch.nn.init.ones_(first.head.weight)
    torch.save({"network": first.state_dict()}, tmp_path / "best.pt")
    start_from(second, tmp_path)
    assert equal(first.body.state_dict(), second.body.state_dict())
    assert not second.head.weight.any()


def test_the_model_folder_answers_what_torch_answers(run, tmp_path):
    model = tmp_path / "crfnet2017"
    model.mkdir()
    network = rounded(load_network(run))
    export_onnx(network, WINDOWED, model / "model.onnx")
    write_config(model, WINDOWED, read_run(run))
    write_golden(network, WINDOWED, model / "golden.npz")
    assert assert_parity(model, model / "golden.npz") < PARITY
    assert 7.7e6 < (model / "model.onnx").stat().st_size < 7.9e6
    windows = np.full((2, 227, 227, 3), 0.5, np.float32)
    assert all(one.is_answer for one in ResponseNetwork.load(model).predict(windows).windows)


def test_an_answer_is_worth_what_its_errors_on_validation_windows_allow(scenes, run):
    """A Student's t of 5 degrees of freedom has 5/3 of the covariance of its scale."""
    network = load_network(run)
    known = torch.from_numpy(EmorBasis.load().project(scenes.curves.double().numpy()))
    rng = torch.Generator().manual_seed(0)
    true, deviations = known[torch.arange(4000) % 4], torch.linspace(0.5, 0.1, 11).double()
    answers = true + deviations * torch.randn(4000, 11, generator=rng).double()
    network.state_worth(answers, true, known)
    covariance = torch.linalg.inv(network.factor @ network.factor.T) * 5 / 3
    torch.testing.assert_close(covariance.diagonal().sqrt().double(), deviations, rtol=0.05, atol=0)
    assert network.log_odds < 0


def test_the_errors_that_count_are_of_validation_windows(scenes, run):
    basis = EmorBasis.load()
    curves = basis.reconstruct(np.random.default_rng(0).normal(0, 0.3, (30, 11)))
    many = replace(scenes, curves=torch.from_numpy(curves).float(), exposures=torch.ones(30))
    network = load_network(run)
    windows = draw_windows(many, 40, seed=2)
    distance = fit_worth(network, windows, many.curves)
    with torch.inference_mode():
        answers = network.network(next(windows.inputs())).numpy()
    true = basis.project(curves)[windows.classes]
    assert distance == pytest.approx(np.linalg.norm(answers - true, axis=1).mean(), abs=1e-4)
    assert not torch.equal(network.factor, torch.eye(11))


def test_folding_changes_nothing():
    torch.manual_seed(0)
    network, windows = CRFNet(), torch.rand(2, 3, 227, 227)
    torch.nn.init.normal_(network.head.weight, std=1e-3)
    with torch.inference_mode():
        network(windows)
        expected = network.eval()(windows)
        assert torch.allclose(fold_normalization(network)(windows), expected, rtol=1e-3, atol=1e-3)


def test_a_run_of_the_first_stage_is_not_exported(tmp_path):
    torch.save({"network": CRFNet(3).state_dict(), "rows": []}, tmp_path / "best.pt")
    with pytest.raises(SystemExit, match="stage classify"):
        load_network(tmp_path)
