// The radius slider's scale: logarithmic, from a hundredth of the largest radius to just below it.

const STEPS = 1000;
/** A radius must stay below the inradius; this share of it is as far as the slider goes. */
const TOP_SHARE = 0.999;

export class RadiusScale {
  /** `largest`: the scene's largest admissible radius; `current`: the one it was prepared with. Scene units. */
  constructor(largest, current) {
    this.top = largest * TOP_SHARE;
    this.bottom = current > 0 ? Math.min(largest * 0.01, current) : largest * 0.01;
    this.steps = STEPS;
  }

  /** Radius at a slider position 0..steps, to three digits, so that like positions share their URLs. */
  radiusAt(position) {
    if (position >= STEPS) return this.top;
    const exact = this.bottom * (this.top / this.bottom) ** (position / STEPS);
    return Math.min(this.top, Number(exact.toPrecision(3)));
  }

  positionOf(radius) {
    const clamped = Math.max(this.bottom, Math.min(this.top, radius));
    return Math.round((STEPS * Math.log(clamped / this.bottom)) / Math.log(this.top / this.bottom));
  }
}
