// The element of the page with an id, or one within it: "health .bar".
export function find(path: string): HTMLElement {
  return document.querySelector(`#${path}`) as HTMLElement;
}
