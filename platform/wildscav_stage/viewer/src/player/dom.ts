// Parts of pages. Text is only ever text: names are chosen by competitors.

type Properties = Record<string, unknown>;

export function make<Tag extends keyof HTMLElementTagNameMap>(
  tag: Tag,
  properties: Properties = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[Tag] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name in element) (element as unknown as Properties)[name] = value;
    else element.setAttribute(name, String(value));
  }
  element.append(...children);
  return element;
}

// A button with a picture, which says what it does to those who point at it or cannot see it.
export function iconButton(icon: keyof typeof ICONS, label: string, onclick: () => void): HTMLButtonElement {
  const button = make("button", { type: "button", className: "player-icon", onclick }, drawing(icon));
  rename(button, label);
  return button;
}

export function rename(button: HTMLButtonElement, label: string): void {
  if (button.title === label) return;
  button.title = label;
  button.setAttribute("aria-label", label);
}

export function picker(
  label: string,
  options: [string, string | number][],
  chosen: string | number,
  onchange: (value: string) => void,
): HTMLSelectElement {
  const list = make("select", { onchange: () => onchange(list.value) });
  list.setAttribute("aria-label", label);
  for (const [text, value] of options) {
    list.append(make("option", { value: String(value), textContent: text, selected: value === chosen }));
  }
  return list;
}

// Outlines in a square of 24 by 24, filled.
const ICONS = {
  play: "M7 4.5v15l13-7.5z",
  pause: "M6 4.5h4.5v15H6zM13.5 4.5H18v15h-4.5z",
  again: "M12 5V1.5L6.5 6 12 10.5V7a6 6 0 1 1-6 6H4a8 8 0 1 0 8-8z",
  back: "M11.5 5v14L2 12zM21 5v14l-9.5-7z",
  on: "M12.5 5v14l9.5-7zM3 5v14l9.5-7z",
  stepBack: "M5 5h3v14H5zM19 5v14l-9-7z",
  stepOn: "M16 5h3v14h-3zM5 5v14l9-7z",
  eventBack: "M13 3h8v6h-2v12h-4V9h-2zM11 7.500v10L2.5 12.500z",
  eventOn: "M3 3h8v6H9v12H5V9H3zM13 7.500v10l8.5-5z",
  link: "M10.6 13.4a1 1 0 0 1-1.4 0 5 5 0 0 1 0-7l3-3a5 5 0 0 1 7 7l-1.6 1.7-1.4-1.5 1.5-1.6a3 3 0 1 0-4.1-4.2l-3 3a3 3 0 0 0 0 4.2 1 1 0 0 1 0 1.4zm2.8-2.8a1 1 0 0 1 1.4 0 5 5 0 0 1 0 7l-3 3a5 5 0 0 1-7-7l1.6-1.7 1.4 1.5-1.5 1.6a3 3 0 1 0 4.1 4.2l3-3a3 3 0 0 0 0-4.2 1 1 0 0 1 0-1.4z",
  full: "M4 4h6v2H6v4H4zM14 4h6v6h-2V6h-4zM4 14h2v4h4v2H4zM18 14h2v6h-6v-2h4z",
  inset: "M3 5h18v14H3zm2 2v10h14V7zm6 4h6v4h-6z",
  help: "M12 2a10 10 0 1 1 0 20 10 10 0 0 1 0-20zm0 2a8 8 0 1 0 0 16 8 8 0 0 0 0-16zm-1 11.5h2v2h-2zm1-9.5a3.6 3.6 0 0 1 1.6 6.8c-.5.3-.6.5-.6 1.2h-2c0-1.6.5-2.3 1.6-2.900A1.6 1.6 0 1 0 10.4 9.600H8.400A3.6 3.6 0 0 1 12 6z",
  nearer: "M11 5h2v6h6v2h-6v6h-2v-6H5v-2h6z",
  farther: "M5 11h14v2H5z",
} as const;

export function setIcon(button: HTMLButtonElement, icon: keyof typeof ICONS): void {
  if (button.dataset.icon === icon) return;
  button.dataset.icon = icon;
  button.replaceChildren(drawing(icon));
}

function drawing(icon: keyof typeof ICONS): SVGSVGElement {
  const space = "http://www.w3.org/2000/svg";
  const svg = document.createElementNS(space, "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS(space, "path");
  path.setAttribute("d", ICONS[icon]);
  path.setAttribute("fill-rule", "evenodd");
  svg.append(path);
  return svg;
}
