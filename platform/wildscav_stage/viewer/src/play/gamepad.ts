// The gamepad, if there is one.

// Some browsers have no gamepads on pages that are not encrypted, or forbid them.
export function standardGamepad(): Gamepad | null | undefined {
  try {
    return navigator.getGamepads?.().find((each) => each?.mapping === "standard");
  } catch {
    return null;
  }
}

// Call a function with the first button that is pressed, if one is: "Pad0".
export function pressedButton(take: (trigger: string) => void): void {
  const pressed = standardGamepad()?.buttons.findIndex((button) => button.pressed) ?? -1;
  if (pressed >= 0) take(`Pad${pressed}`);
}
