// What agents said and drew, as platform/wildscav_stage/scene/notes.py describes it.

const NOTES_VERSION = 1;

// A note has a text, or a name with points; or a name with a value, of which pages show nothing.
export interface Note {
  frame: number;
  seat: number;
  text: string;
  name: string;
  points: [number, number, number][]; // cm: x, height, z; none removes the mark of this name
  value: number | null;
}

// Read the text of a document. It throws an Error whose message a person can read.
export function readNotes(text: string): Note[] {
  const { version, notes } = JSON.parse(text) as { version: number; notes: Note[] };
  if (version !== NOTES_VERSION)
    throw new Error(`this page reads notes of version ${NOTES_VERSION}, not ${version}`);
  return notes;
}
