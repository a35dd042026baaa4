"""Training of policies: a PPO to read and to start from, its checkpoints, and what ``wildscav train`` runs.

Only ``ppo`` and what uses it needs PyTorch, of the extra ``training``.
"""
