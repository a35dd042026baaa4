// Where something is, seen from somewhere.

export type Place = { x: number; z: number };

export interface Bearing {
  bearing: number; // degrees by the compass
  distance: number; // m
}

export function bearingOf(here: Place, there: Place): Bearing {
  const [east, north] = [there.x - here.x, there.z - here.z];
  return { bearing: (Math.atan2(east, north) * 180) / Math.PI, distance: Math.hypot(east, north) };
}
