"""Agents that many tests play with: the body of a class each, for the fixture ``submit``."""

import subprocess
from collections.abc import Callable

from wildscav_evaluator.submissions.submission import Submission

Submit = Callable[..., Submission]  # the fixture that writes a submission
Command = Callable[..., "subprocess.CompletedProcess[str]"]  # the fixture that runs `wildscav`

# Walks in circles.
WALKER = """
    def act(self, observation):
        return Action(walk_direction=observation.step * 10.0, walk_speed=6.0)
"""
# Walks, and says so at every step.
TALKER = """
    def act(self, observation):
        print("step", observation.step)
        return Action(walk_speed=5.0)
"""
# Raises an exception, with a text that would clear the screen, break markup and turn the line around.
CRASHER = """
    def act(self, observation):
        if observation.step == 7:
            raise RuntimeError("lost the thread \\x1b[2J[/]\\u202e")
        return Action()
"""
# Ends its process.
QUITTER = """
    def act(self, observation):
        print("going")
        os._exit(7)
"""
# Says which process it is, and is silent.
SLEEPER = """
    def act(self, observation):
        print(os.getpid(), flush=True)
        time.sleep(600)
"""
# Asks its model at every step, as any program can, and prints what it gets.
ASKER = """
    def ask(self, step):
        import http.client, json, socket
        connection = http.client.HTTPConnection("model")
        connection.sock = socket.socket(socket.AF_UNIX)
        connection.sock.connect(os.environ["WILDSCAV_MODEL"].removeprefix("unix:"))
        messages = [{"role": "user", "content": f"{os.path.basename(os.getcwd())} {step}"}]
        connection.request("POST", "/v1/chat/completions", json.dumps({"messages": messages}))
        response = connection.getresponse()
        return response.status, response.read().decode()

    def act(self, observation):
        print(*self.ask(observation.step))
        return Action(walk_speed=5.0)
"""


# Kills the process that started it, once.
KILLS_ITS_FIRST_WORKER = """
    def act(self, observation):
        print("step", observation.step)
        if observation.step == 7 and not os.path.exists("was_here"):
            open("was_here", "w").close()
            os.kill(os.getppid(), signal.SIGKILL)
            time.sleep(600)
        return Action(walk_speed=5.0)
"""
