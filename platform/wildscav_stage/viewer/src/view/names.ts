// How names of agents are written over the picture.

// CSS pixels: the height of a label, and its greatest width.
export const LABEL_HEIGHT = 18;
export const LABEL_WIDTH = 160;
const FONT = "600 12px system-ui, -apple-system, 'Segoe UI', Roboto, sans-serif";

// Draw a name in its box, and return its width. Given a height, the box is centred there.
export function drawName(
  context: CanvasRenderingContext2D,
  name: string,
  color: number[],
  middle?: number,
): number {
  context.font = FONT;
  const width = Math.min(LABEL_WIDTH - 2, Math.ceil(context.measureText(name).width) + 20);
  context.save();
  if (middle !== undefined) context.translate(-width / 2, middle);
  context.fillStyle = "rgba(12, 16, 22, 0.82)";
  fillRounded(context, 0, 0, width, LABEL_HEIGHT - 1, 4);
  context.fillStyle = `rgb(${color.join(" ")})`;
  fillRounded(context, 4, 4, 7, LABEL_HEIGHT - 9, 2);
  context.fillStyle = "#fff";
  context.textBaseline = "middle";
  context.fillText(name, 15, LABEL_HEIGHT / 2, width - 19);
  context.restore();
  return width;
}

// Old browsers have no rounded rectangles.
function fillRounded(
  context: CanvasRenderingContext2D,
  ...[x, y, width, height, radius]: [number, number, number, number, number]
): void {
  context.beginPath();
  if (typeof context.roundRect === "function") context.roundRect(x, y, width, height, radius);
  else context.rect(x, y, width, height);
  context.fill();
}
