import { Skeleton, useComputedColorScheme } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { mappingPreviewQuery } from "../../api/queries";
import { figureHeight } from "../../lib/figures/figureLayout";
import { FigureBoundary } from "../figures/FigureBoundary";
import type { PlotlyHandle } from "../figures/figureEvents";
import { PlotlyCanvas } from "../figures/PlotlyCanvas";
import { ProblemAlert } from "../display/ProblemAlert";
import { Section } from "../display/Section";

interface Props {
  id: string;
  mapping: string;
  channels: string[];
}

/** Preview of the channels as imported. */
export function MappingPreview({ id, mapping, channels }: Props) {
  const scheme = useComputedColorScheme("light");
  const preview = useQuery(mappingPreviewQuery(id, mapping, channels));
  const [handle, setHandle] = useState<PlotlyHandle | null>(null);
  const spec = preview.data;
  return (
    <Section
      title="Preview"
      note={
        channels.length === 0
          ? "First channels as imported; select others in the table to plot them"
          : "Selected channels as imported"
      }
    >
      <div data-testid="mapping-preview" data-drawn={handle !== null && spec !== undefined}>
        {preview.isError && <ProblemAlert error={preview.error} />}
        {spec === undefined && !preview.isError && <Skeleton height={300} radius="sm" />}
        {spec !== undefined && (
          <FigureBoundary attempt={spec}>
            <PlotlyCanvas
              spec={spec}
              scheme={scheme}
              height={figureHeight(spec.layout)}
              revision={channels.join(",")}
              onReady={setHandle}
            />
          </FigureBoundary>
        )}
      </div>
    </Section>
  );
}
