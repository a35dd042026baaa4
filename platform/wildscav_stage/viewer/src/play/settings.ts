// What a person has chosen, kept in the browser for the next game.

export interface Settings {
  sensitivity: number; // of the mouse, 1 as usual
  invert: boolean; // whether the view goes up when the mouse goes down
  field: number; // degrees of view across
  volume: number; // 0-1
}

const KEY = "wildscav-settings";
export const DEFAULTS: Settings = { sensitivity: 1, invert: false, field: 85, volume: 0.7 };
const LIMITS: Record<string, [number, number]> = {
  sensitivity: [0.1, 5],
  field: [60, 90], // what is farther aside is not told
  volume: [0, 1],
};

export function remembered(key: string): string {
  try {
    return localStorage.getItem(key) ?? "";
  } catch {
    return ""; // a browser may forbid it
  }
}

export function remember(key: string, value: string): void {
  try {
    localStorage.setItem(key, value);
  } catch {
    // Likewise.
  }
}

// Return what a text says of settings, and the defaults for what it does not say rightly.
export function settingsOf(text: string): Settings {
  let kept: Partial<Record<keyof Settings, unknown>> = {};
  try {
    kept = JSON.parse(text || "{}") ?? {};
  } catch {
    // Somebody else has written there.
  }
  const number = (name: "sensitivity" | "field" | "volume") => {
    const [least, most] = LIMITS[name];
    const value = kept[name];
    return typeof value === "number" && value >= least && value <= most ? value : DEFAULTS[name];
  };
  return {
    sensitivity: number("sensitivity"),
    invert: kept.invert === true,
    field: number("field"),
    volume: number("volume"),
  };
}

// Fill a form with the settings that were kept, and keep what is changed in it. Its fields are named as they are.
export function settingsIn(form: HTMLFormElement): Settings {
  const settings = settingsOf(remembered(KEY));
  for (const input of form.querySelectorAll("input")) {
    const name = input.name as keyof Settings;
    if (input.type === "checkbox") input.checked = Boolean(settings[name]);
    else input.value = String(settings[name]);
    input.addEventListener("input", () => {
      const value = input.type === "checkbox" ? input.checked : Number(input.value);
      Object.assign(settings, settingsOf(JSON.stringify({ ...settings, [name]: value })));
      remember(KEY, JSON.stringify(settings));
    });
  }
  form.addEventListener("submit", (event) => event.preventDefault());
  return settings;
}
