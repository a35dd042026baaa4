"""What agents need again and again: walking, mapping, gathering, aiming, and staying in the safe zone.

The strong baselines are made of these, and any submission may import them: like the rest of the SDK, they see
nothing but what an agent is told.
"""
