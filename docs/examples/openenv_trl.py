"""GRPO with TRL on seats of words: a language model learns to navigate by tools, over OpenEnv.

By default the model is a toy, so that the example needs no download and no graphics card: a network of 10,000
weights, each of whose words is a whole call of a tool. It learns which call leads to the target. With
``--model Qwen/Qwen3-0.6B``, or any other model that calls tools, the same lines train that model.

It needs an environment of its own, and a server that runs there:

    pip install -e '.[openenv]' 'trl>=1.16' 'transformers>=5.13' torch
    python -m wildscav_language.openenv.app
"""

import argparse
import json
from typing import Any

from wildscav_language.openenv.client import WildscavEnv
from wildscav_language.openenv.models import WildscavAction, WildscavObservation

TASK = "You play a seat of a 3D world by calling tools. Reach the target as fast as you can."
TIME_LIMIT = 20.0  # s
OPTIONS: dict[str, Any] = {"track": "navigation", "map": 103, "time_limit": TIME_LIMIT}
# The words of the toy.
CALLS: list[tuple[str, dict[str, Any]]] = [
    ("go", {"place": "target"}),
    ("go", {"place": "start"}),
    ("explore", {"seconds": 5.0}),
    ("look_around", {}),
    ("wait_until", {"seconds": 5.0}),
    ("jump", {}),  # there is no such tool
]


class Navigation:
    """A match as TRL's trainer sees it: ``reset``, a method for each tool, and the reward of it all.

    Args:
        url: Of the server.
    """

    def __init__(self, url: str) -> None:
        self._client = WildscavEnv(base_url=url).sync()
        self._seen = WildscavObservation(text="", done=True)
        self._reward, self._left = 0.0, 0.0

    def reset(self, seed: int, **_: Any) -> str:
        """Begin a match, and return its rules and what the seat senses."""
        self._reward, self._left = 0.0, TIME_LIMIT
        self._seen = self._client.reset(seed=seed, **OPTIONS).observation
        return self._seen.text

    def get_reward(self) -> float:
        """Return by how much the score got better, if the seat stands still for the time that is left."""
        return self._reward if self._seen.done else self._reward - self._left

    def go(self, place: str, seconds: float = 15.0) -> str:
        """Walk to a named place, past what is in the way.

        Args:
            place: A name from the text, such as target.
            seconds: At most.

        Returns:
            Why the walk ended, and what you sense then.
        """
        return self._call("go", place=place, seconds=seconds)

    def explore(self, seconds: float = 20.0) -> str:
        """Walk to places that you have not visited yet.

        Args:
            seconds: At most.

        Returns:
            Why the walk ended, and what you sense then.
        """
        return self._call("explore", seconds=seconds)

    def look_around(self) -> str:
        """Turn once around.

        Returns:
            What you sense then.
        """
        return self._call("look_around")

    def wait_until(self, seconds: float = 5.0) -> str:
        """Stand and wait.

        Args:
            seconds: At most.

        Returns:
            What you sense then.
        """
        return self._call("wait_until", seconds=seconds)

    def _call(self, tool: str, **arguments: Any) -> str:
        if not self._seen.done:
            result = self._client.step(WildscavAction(tool=tool, arguments=arguments))
            self._seen = result.observation
            self._reward += result.reward
            self._left -= result.metadata["seconds"]
        return self._seen.text


def toy() -> tuple[Any, Any]:
    """Return a small random model, and a tokenizer whose words are calls."""
    import torch
    from tokenizers import Regex, Tokenizer, models, pre_tokenizers
    from transformers import PreTrainedTokenizerFast, Qwen3Config, Qwen3ForCausalLM, set_seed
    from trl.chat_template_utils import qwen3_chat_template

    set_seed(0)
    torch.set_num_threads(1)  # the model is too small for more
    said = [json.dumps({"name": name, "arguments": arguments}) for name, arguments in CALLS]
    calls = [f"<tool_call>\n{call}\n</tool_call>" for call in said]
    words = ["<|endoftext|>", "<|im_start|>", "<|im_end|>", "[UNK]", *calls]
    tokenizer = Tokenizer(models.WordLevel({word: number for number, word in enumerate(words)}, "[UNK]"))
    tokenizer.pre_tokenizer = pre_tokenizers.Split(Regex(r"\s+"), "removed")
    processing = PreTrainedTokenizerFast(
        tokenizer_object=tokenizer,
        eos_token="<|im_end|>",  # noqa: S106 - no password
        pad_token="<|endoftext|>",  # noqa: S106
        unk_token="[UNK]",  # noqa: S106
        extra_special_tokens=["<|im_start|>"],
    )
    processing.chat_template = qwen3_chat_template
    config = Qwen3Config(
        vocab_size=len(words),
        hidden_size=32,
        intermediate_size=64,
        num_hidden_layers=1,
        num_attention_heads=2,
        num_key_value_heads=2,
        head_dim=16,
        eos_token_id=list(range(len(words))),  # what it says is one word
        pad_token_id=processing.pad_token_id,
    )
    return Qwen3ForCausalLM(config), processing


def train(url: str, model: str | None, steps: int, matches: int) -> None:
    """Train a model, and print the mean reward of each step.

    Args:
        url: Of the server.
        model: Its name or folder; None for the toy.
        steps: Of the trainer.
        matches: In each step, half of them with the same seed.
    """
    from datasets import Dataset
    from trl import GRPOConfig, GRPOTrainer

    policy, processing = toy() if model is None else (model, None)
    rows = [{"prompt": [{"role": "user", "content": TASK}], "seed": seed} for seed in range(2 * steps)]
    trainer = GRPOTrainer(
        model=policy,
        processing_class=processing,
        train_dataset=Dataset.from_list(rows),
        environment_factory=lambda: Navigation(url),
        args=GRPOConfig(
            output_dir="out/openenv-trl",
            max_steps=steps,
            per_device_train_batch_size=matches,
            num_generations=matches // 2,
            max_completion_length=1024,
            max_tool_calling_iterations=4,
            learning_rate=1e-5 if model else 3e-2,
            logging_steps=1,
            save_strategy="no",
            report_to="none",
            use_cpu=model is None,
        ),
    )
    trainer.train()
    for entry in trainer.state.log_history:
        if "reward" in entry:
            print(f"step {entry['step']:3}  reward {entry['reward']:7.2f}")


def main() -> None:
    """Train at a server."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--url", default="http://127.0.0.1:8000", help="of the server")
    parser.add_argument("--model", help="name or folder of a model that calls tools; by default, a toy")
    parser.add_argument("--steps", type=int, default=20, help="of the trainer")
    parser.add_argument(
        "--matches",
        type=int,
        default=16,
        help="in each step, an even number up to the server's sessions",
    )
    chosen = parser.parse_args()
    train(chosen.url, chosen.model, chosen.steps, chosen.matches)


if __name__ == "__main__":
    main()
