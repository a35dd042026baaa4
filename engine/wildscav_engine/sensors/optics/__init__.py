"""Code that all ray-casting sensors share: cameras, and the agents and boxes that they see."""
