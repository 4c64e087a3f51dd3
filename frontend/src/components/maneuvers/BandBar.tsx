import { ButtonLink } from "../controls/ButtonLink";
import { WindowBar } from "./WindowBar";

interface Props {
  maneuverId: number;
  window: [number, number] | undefined;
  onClear: () => void;
  /** Run whose choices a run in this band begins with. */
  template?: number;
}

/** The selected band, with a link to fit it and a button to clear it. */
export function BandBar({ maneuverId, window, onClear, template }: Props) {
  return (
    <WindowBar
      window={window}
      unit="Hz"
      onClear={onClear}
      hint="Drag over a figure to select a band; spectra, responses and fits share it."
      whole="Whole band"
    >
      <ButtonLink
        size="compact-xs"
        to="/maneuvers/$id/new-run"
        params={{ id: maneuverId }}
        search={{ low: window?.[0], high: window?.[1], template_run: template }}
        data-testid="run-band"
      >
        New run in this band
      </ButtonLink>
    </WindowBar>
  );
}
