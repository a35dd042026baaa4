"""Play by the Model Context Protocol: start a match on `wildscav mcp`, and walk to the target."""

import asyncio
import re

from mcp import ClientSession, StdioServerParameters
from mcp.client.stdio import stdio_client


async def main() -> None:
    """Play a navigation, and print what the server says."""
    server = StdioServerParameters(command="wildscav", args=["mcp", "--out", "matches"])
    async with stdio_client(server) as streams, ClientSession(*streams) as session:
        await session.initialize()

        async def call(tool: str, **arguments: object) -> str:
            result = await session.call_tool(tool, arguments)
            return result.content[0].text

        begun = await call("start_match", track="navigation", level="easy", seed=3)
        seat = re.search(r"^seat: (\S+)", begun, re.MULTILINE)[1]
        print(await call("observe", seat=seat))
        said = ""
        while "The match is over" not in said:
            said = await call("go", seat=seat, place="target", seconds=20)
        print(said)
        print(await call("record", seat=seat))


asyncio.run(main())
