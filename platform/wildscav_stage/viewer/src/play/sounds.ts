// Sounds, made of noise and tones: there are no files to load. Those of others come from where they are.

import type { Settings } from "./settings";

const NEAR = 6; // m, up to which a sound is as loud as it is

export class Sounds {
  on = true;
  private context: AudioContext | null = null;
  private noise: AudioBuffer | null = null;
  private out: GainNode | null = null;

  constructor(private readonly settings: Settings) {}

  // Browsers allow sound only once somebody has clicked.
  unlock(): void {
    this.context ??= new AudioContext();
    this.context.resume();
    this.noise ??= noiseFor(this.context);
    if (this.out) return;
    this.out = this.context.createGain();
    this.out.connect(this.context.destination);
  }

  // A shot: to the right (-1 to 1) by how much, and at what distance in m.
  shot(aside = 0, distance = 0): void {
    const near = NEAR / Math.max(NEAR, distance);
    this.burst(600 + 1200 * near, 0.5 * near, 0.16 + 0.1 * (1 - near), aside);
  }

  hit(): void {
    this.tone(1500, 900, 0.28, 0.08);
  }

  hurt(): void {
    this.burst(300, 0.8, 0.25, 0);
  }

  gain(): void {
    [660, 880].forEach((tone, index) => {
      this.tone(tone, tone * 1.01, 0.2, 0.12, index * 0.09);
    });
  }

  tick(): void {
    this.tone(440, 440, 0.17, 0.1);
  }

  end(): void {
    [523, 659, 784].forEach((tone, index) => {
      this.tone(tone, tone, 0.2, 0.25, index * 0.16);
    });
  }

  private fading(context: AudioContext, volume: number, seconds: number): GainNode {
    const gain = context.createGain();
    const now = context.currentTime;
    gain.gain.setValueAtTime(Math.max(0.0002, volume * this.settings.volume), now);
    gain.gain.exponentialRampToValueAtTime(0.0001, now + seconds);
    return gain;
  }

  private burst(frequency: number, volume: number, seconds: number, aside: number): void {
    if (!this.on || !this.context || !this.out) return;
    const source = this.context.createBufferSource();
    const filter = this.context.createBiquadFilter();
    const panner = this.context.createStereoPanner();
    source.buffer = this.noise;
    filter.type = "lowpass";
    filter.frequency.value = frequency;
    panner.pan.value = Math.max(-1, Math.min(1, aside));
    const fading = this.fading(this.context, volume, seconds);
    source.connect(filter).connect(fading).connect(panner).connect(this.out);
    source.start();
    source.stop(this.context.currentTime + seconds);
  }

  private tone(from: number, to: number, volume: number, seconds: number, delay = 0): void {
    if (!this.on || !this.context || !this.out) return;
    const tone = this.context.createOscillator();
    const start = this.context.currentTime + delay;
    tone.frequency.setValueAtTime(from, start);
    tone.frequency.exponentialRampToValueAtTime(to, start + seconds);
    tone.connect(this.fading(this.context, volume, seconds + delay)).connect(this.out);
    tone.start(start);
    tone.stop(start + seconds);
  }
}

function noiseFor(context: AudioContext): AudioBuffer {
  const buffer = context.createBuffer(1, context.sampleRate / 2, context.sampleRate);
  const samples = buffer.getChannelData(0);
  for (let index = 0; index < samples.length; index++) samples[index] = Math.random() * 2 - 1;
  return buffer;
}
