// Elements of the page.

// The element with an id, or one within it: "health .bar".
export function find(path: string): HTMLElement {
  return document.querySelector(`#${path}`) as HTMLElement;
}

export function element(name: string, text = ""): HTMLElement {
  const made = document.createElement(name);
  made.textContent = text;
  return made;
}

export function button(label: string, press: (button: HTMLButtonElement) => void): HTMLButtonElement {
  const made = element("button", label) as HTMLButtonElement;
  made.type = "button";
  made.addEventListener("click", () => press(made));
  return made;
}
