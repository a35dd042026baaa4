"""Self-play with a league: evolution strategies on a linear policy, with NumPy alone.

Every match of a vector environment plays another variation of the policy against three opponents from the
league: past selves and robots. The policy moves towards the variations that scored best, and joins the league
now and then. Run it with ``python docs/examples/self_play.py``; it takes about 40 s of one core.

Method: Salimans et al., "Evolution Strategies as a Scalable Alternative to Reinforcement Learning", 2017.
"""

import argparse
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.envs import League, VectorArena
from wildscav_engine.specs.map_spec import MapConfig

Numbers = NDArray[np.float32]

OPTIONS: dict[str, Any] = {
    "map": MapConfig(size=60, houses=0, water=0.0, vegetation=0.3),
    "random_maps": 8,
    "time_limit": 30.0,
    "supplies": {"waves": [{"center": (0.0, 0.0), "radius": 40.0, "outdoor_richness": 50.0}], "spacing": 4.0},
    "sensors": {"nearby_supplies": {"limit": 1}, "visible_agents": {"limit": 1}},
    "rewards": {"supply_found": 1.0, "kill": 1.0, "death": -1.0},
    "flat": True,
    "action_mode": "box",
}
SEATS = 3  # of opponents in a match
NOISE = 0.3  # standard deviation of the variations
RATE = 1.0  # of learning
ROBOTS = ("walker", "fighter-easy")


def linear(weights: Numbers, observations: Numbers) -> Numbers:
    """Return (N, k) actions in [-1, 1] for (N, n) observations.

    Args:
        weights: (n + 1, k), of a policy that plays all rows; or (N, n + 1, k), of one for each row.
        observations: (N, n) rows.
    """
    inputs = np.concatenate([observations, np.ones_like(observations[:, :1])], axis=1)
    return np.tanh((inputs[:, np.newaxis] @ weights)[:, 0])


def policy_of(weights: Numbers) -> Any:
    """Return the policy with these weights, as the league keeps it."""
    return lambda observations: linear(weights, observations)


def play(envs: VectorArena, weights: Numbers, seed: int) -> NDArray[np.float64]:
    """Play one episode in every row, and return (N,) the sum of its rewards."""
    observations, _ = envs.reset(seed=seed)
    returns, playing = np.zeros(envs.num_envs), np.ones(envs.num_envs, np.bool_)
    while playing.any():
        observations, rewards, terminated, truncated, _ = envs.step(linear(weights, observations))
        returns += rewards * playing
        playing &= ~(terminated | truncated)
    return returns


def win_shares(weights: Numbers, first: Numbers, matches: int) -> list[float]:
    """Return the share of wins, counting draws by half, against each robot and against the first self."""
    alone = {"latest_share": 1.0, "robot_share": 0.0}
    rivals = [League(robots=(name,)) for name in ROBOTS] + [League(factory=policy_of, **alone)]
    rivals[-1].add(first)
    shares = []
    for rival in rivals:
        envs = VectorArena("battle", matches, opponents=(rival,), **OPTIONS | {"split": "test"})
        play(envs, weights, seed=0)
        (results,) = rival.results.values()
        shares.append((results.wins + 0.5 * results.draws) / results.games)
    return shares


def improved(weights: Numbers, envs: VectorArena, seed: int) -> Numbers:
    """Return the weights after one step of learning."""
    random = np.random.default_rng(seed)
    half = random.standard_normal((envs.num_envs // 2, *weights.shape), np.float32)
    noise = np.concatenate([half, -half])
    returns = play(envs, weights + NOISE * noise, seed)
    # Ranks instead of returns, from -0.5 for the worst to 0.5 for the best.
    ranks = returns.argsort(kind="stable").argsort() / (len(returns) - 1) - 0.5
    gradient = np.tensordot(ranks, noise, axes=1) / (len(returns) * NOISE)
    return weights + np.float32(RATE) * gradient.astype(np.float32)


def train(iterations: int, matches: int, every: int) -> League:
    """Train a policy, print how well it plays, and return its league.

    Args:
        iterations: The number of steps of learning.
        matches: The number of variations in each.
        every: The number of iterations after which the policy joins the league.
    """
    league = League(factory=policy_of, robots=ROBOTS, latest_share=0.3, robot_share=0.2, capacity=16)
    envs = VectorArena("battle", matches, opponents=(league,) * SEATS, **OPTIONS)
    inputs, outputs = envs.single_observation_space.shape[0] + 1, envs.single_action_space.shape[0]
    weights = first = np.zeros((inputs, outputs), np.float32)
    print("iteration" + "".join(f"{f'vs {name}':>17}" for name in (*ROBOTS, "first self")))
    for iteration in range(iterations + 1):
        if iteration % every == 0:
            league.add(weights)
            shares = win_shares(weights, first, matches)
            print(f"{iteration:9}" + "".join(f"{share:17.0%}" for share in shares), flush=True)
        if iteration < iterations:
            weights = improved(weights, envs, seed=iteration)
    print("\nopponent in the league    games    recent win rate")
    for name, results in league.results.items():
        print(f"{name:22}  {results.games:7}  {results.win_rate:17.2f}")
    return league


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--iterations", type=int, default=100, help="steps of learning")
    parser.add_argument(
        "--matches", type=int, default=64, help="variations of the policy in each, an even number"
    )
    parser.add_argument("--every", type=int, default=10, help="iterations from one past self to the next")
    chosen = parser.parse_args()
    train(chosen.iterations, chosen.matches, chosen.every)
