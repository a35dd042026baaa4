"""What the gateway to a language model adds to a request.

The same question is asked of a scripted server that answers at once, and of a gateway before it, in turns:
with a short prompt, and with a long one that holds a picture.
"""

import asyncio
import base64
import statistics
import tempfile
import time
from io import BytesIO
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import typer
from benchmarks.report import Figure, JsonFile, publish
from PIL import Image
from tests.scripted_model import ScriptedModel, in_turn, said

from wildscav_evaluator.model_gateway.gateway import open_gateway
from wildscav_evaluator.model_gateway.settings import ModelSettings

REQUESTS, ROUNDS = 40, 5
LONG = 20_000  # characters of a long prompt
SIDES = (480, 320)  # pixels of its picture


def question(characters: int, *, picture: bool) -> dict[str, Any]:
    """Return a request with a prompt of so many characters."""
    parts: list[dict[str, Any]] = [{"type": "text", "text": "x" * characters}]
    if picture:
        content, noise = BytesIO(), np.random.default_rng(0).integers(0, 256, (*SIDES[::-1], 3), np.uint8)
        Image.fromarray(noise // 32 * 32).save(content, "PNG")
        data = base64.b64encode(content.getvalue()).decode()
        parts.append({"type": "image_url", "image_url": {"url": f"data:image/png;base64,{data}"}})
    return {"messages": [{"role": "user", "content": parts}]}


async def times_of(client: httpx.AsyncClient, url: str, body: dict[str, Any]) -> list[float]:
    """Return how long some requests take, ms."""
    times = []
    for _ in range(REQUESTS):
        began = time.perf_counter()
        (await client.post(url, json=body)).raise_for_status()
        times.append((time.perf_counter() - began) * 1e3)
    return times


async def measure(folder: Path) -> list[Figure]:
    """Measure short and long requests."""
    figures = []
    with ScriptedModel(in_turn(said("go on"))) as model:
        settings = ModelSettings(url=model.url, name="tiny", requests=10**6, tokens=10**12)
        async with (
            open_gateway(settings, {0: folder}, folder / "exchanges.jsonl.gz") as gateway,
            httpx.AsyncClient(trust_env=False) as plain,
            httpx.AsyncClient(transport=httpx.AsyncHTTPTransport(uds=str(folder / "model.sock"))) as through,
        ):
            if gateway is None:
                raise RuntimeError("there is no gateway")
            for name, body in (
                ("a short prompt", question(200, picture=False)),
                ("20,000 characters and a picture", question(LONG, picture=True)),
            ):
                direct: list[float] = []
                behind: list[float] = []
                for _ in range(ROUNDS):
                    direct += await times_of(plain, f"{model.url}/chat/completions", body)
                    behind += await times_of(through, "http://model/v1/chat/completions", body)
                figures += [
                    Figure(f"{name}: added, least", min(behind) - min(direct), "ms"),
                    Figure(
                        f"{name}: added, median", statistics.median(behind) - statistics.median(direct), "ms"
                    ),
                ]
    return figures


def main(json: JsonFile = None) -> None:
    """Measure what the gateway adds to a request."""
    with tempfile.TemporaryDirectory() as folder:
        publish("the gateway to a language model", asyncio.run(measure(Path(folder))), json)


if __name__ == "__main__":
    typer.run(main)
