// The view from above: which part of the map is seen, north up.

const LEAST = 20; // m across, as close as one may look
const MARGIN = 1.06; // how much more than the map is seen at first

export class MapView {
  x = 0; // m, the middle
  z = 0;
  private share = 1; // of the whole map

  // size: of the map in m. It begins with the whole map.
  constructor(private readonly size: number) {}

  // x and z in the middle, and how much is seen across, m.
  get place(): number[] {
    return [this.x, this.z, this.size * this.share];
  }

  set place([x, z, across]: number[]) {
    this.setShare(across / this.size);
    this.moveTo(x, z);
  }

  // How many metres a pixel covers on a canvas of some size.
  scale(width: number, height: number): number {
    return (MARGIN * this.size * this.share) / Math.max(1, Math.min(width, height));
  }

  drag(right: number, down: number, width: number, height: number): void {
    const scale = this.scale(width, height);
    this.moveTo(this.x - right * scale, this.z + down * scale);
  }

  // Zoom so that what lies under a pixel stays there.
  zoom(factor: number, x: number, y: number, width: number, height: number): void {
    const before = this.scale(width, height);
    this.setShare(this.share / factor);
    const change = before - this.scale(width, height);
    this.moveTo(this.x + (x - width / 2) * change, this.z - (y - height / 2) * change);
  }

  private setShare(share: number): void {
    this.share = Math.min(1.5, Math.max(LEAST / this.size, share));
  }

  private moveTo(x: number, z: number): void {
    const half = this.size / 2;
    this.x = Math.min(half, Math.max(-half, x));
    this.z = Math.min(half, Math.max(-half, z));
  }
}
