import {
  ActionIcon,
  Group,
  Loader,
  Menu,
  Skeleton,
  Text,
  Tooltip,
  useComputedColorScheme,
} from "@mantine/core";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useEffect, useState } from "react";
import { address, type QueryValue } from "../../api/client";
import { asProblem } from "../../api/problem";
import { usePrintReport } from "../../api/commands";
import { figureQuery } from "../../api/queries";
import { useConversion, useUnitParameters } from "../../api/units";
import { figureHeight, rounded } from "../../lib/figures/figureLayout";
import { Empty } from "../display/Empty";
import { FigureBoundary } from "./FigureBoundary";
import type { FigureEvents, PlotlyHandle } from "./figureEvents";
import { DownloadIcon } from "../display/icons";
import { loadPlotly } from "./plotly";
import { PlotlyCanvas } from "./PlotlyCanvas";
import { PrintFigure, usePrintFormat } from "./PrintFigure";
import { PrintedPdf } from "../controls/ReportMenu";
import { ProblemAlert } from "../display/ProblemAlert";

interface Props extends FigureEvents {
  /** Figure of the API, /api/v1/figures/{kind}. */
  kind: string;
  params: Record<string, QueryValue>;
  title?: string;
  /** Fixed height where the spec's own rows should not decide. [px] */
  height?: number;
  /** Zoom is retained while this is unchanged; by default while the figure is the same. */
  revision?: string;
  /** Window of the x axis that figures share [s] or [Hz]; they hand it on by `onWindow`. */
  window?: [number, number];
}

/** A figure that the server built: fetched, drawn in the page's colors, downloadable. */
export function Figure({ kind, params: given, title, height, revision, window, ...events }: Props) {
  const scheme = useComputedColorScheme("light");
  const units = useUnitParameters();
  const params = { ...given, ...units };
  const perHertz = useConversion()("Hz").factor;
  // The page's windows over frequency are in Hz, whatever the figure shows.
  const factor = events.link === "frequency" ? perHertz : 1;
  const shown = window && ([factor * window[0], factor * window[1]] as [number, number]);
  const figure = useQuery(figureQuery(kind, params));
  const [handle, setHandle] = useState<PlotlyHandle | null>(null);
  useEffect(() => {
    loadPlotly().catch(() => undefined);
  }, []);
  const { onWindow } = events;
  const spec = figure.data;
  const note = (spec?.layout.meta as { note?: unknown } | undefined)?.note;
  const tall = height ?? (spec ? figureHeight(spec.layout) : 380);
  const [isPrinting, setPrinting] = useState(false);
  const print = usePrintFormat();
  const name = ["flexsid", kind, ...idsIn(params)].join("-");
  const file = (format: "csv" | "mat" | "json", more: Record<string, QueryValue> = {}) => ({
    href: address(`figures/${kind}`, { ...params, ...more, format }),
    download: `${name}.${format}`,
  });

  const isStored = kind !== "live-bode"; // which changes while a job would print it
  const pdf = usePrintReport();
  const printPdf = (titled = "") => {
    const figure = address(kind, given).replace("/api/v1/", "");
    const more = { ...units, ...print, figure_title: titled === "" ? undefined : titled };
    pdf.mutate(address("reports/figure", { figure, ...more }));
  };

  return (
    <section
      aria-label={title ?? kind}
      data-testid={`figure-${kind}`}
      data-drawn={handle !== null && spec !== undefined && !figure.isPlaceholderData}
    >
      <Group justify="space-between" mih={28} wrap="nowrap" gap="xs">
        <Text size="sm" fw={600}>
          {title}
        </Text>
        <Group gap={6} wrap="nowrap" className="no-print">
          {figure.isFetching && spec !== undefined && (
            <Loader size={12} role="status" aria-label="Refreshing" />
          )}
          {spec !== undefined && (
            <Menu position="bottom-end">
              <Menu.Target>
                <Tooltip label="Download figure">
                  <ActionIcon
                    variant="subtle"
                    color="gray"
                    size="sm"
                    aria-label={`Download ${title ?? kind}`}
                  >
                    <DownloadIcon size={14} />
                  </ActionIcon>
                </Tooltip>
              </Menu.Target>
              <Menu.Dropdown>
                {(["png", "svg"] as const).map((format) => (
                  <Menu.Item
                    key={format}
                    onClick={() => {
                      handle?.download(format, name);
                    }}
                  >
                    {format.toUpperCase()}
                  </Menu.Item>
                ))}
                {isStored && (
                  <Menu.Item
                    data-testid="figure-pdf"
                    onClick={() => {
                      printPdf();
                    }}
                  >
                    PDF
                  </Menu.Item>
                )}
                {(["csv", "mat", "json"] as const).map((format) => (
                  <Menu.Item key={format} component="a" {...file(format)}>
                    {format.toUpperCase()}
                  </Menu.Item>
                ))}
                <Menu.Divider />
                <Menu.Item
                  data-testid="print-figure"
                  onClick={() => {
                    setPrinting(true);
                  }}
                >
                  Size, font and title …
                </Menu.Item>
              </Menu.Dropdown>
            </Menu>
          )}
        </Group>
      </Group>
      {isPrinting && (
        <PrintFigure
          name={title ?? kind}
          onClose={() => {
            setPrinting(false);
          }}
          onImage={(format, titled) => {
            handle?.download(format, name, { format: print, title: titled });
          }}
          onPdf={
            isStored
              ? (titled) => {
                  setPrinting(false);
                  printPdf(titled);
                }
              : undefined
          }
          json={(titled) =>
            file("json", { ...print, figure_title: titled === "" ? undefined : titled })
          }
        />
      )}
      <PrintedPdf print={pdf} title={`PDF of ${title ?? kind}`} />
      {typeof note === "string" && (
        <Text size="xs" className="quiet" mb={4}>
          {note}
        </Text>
      )}
      {figure.isError && <Undrawn error={figure.error} onRetry={() => void figure.refetch()} />}
      {spec === undefined && !figure.isError && (
        <Skeleton
          height={tall}
          radius="sm"
          role="status"
          aria-label="Loading figure"
          aria-busy="true"
        />
      )}
      {spec !== undefined && (
        <FigureBoundary attempt={spec}>
          <PlotlyCanvas
            spec={spec}
            scheme={scheme}
            height={tall}
            revision={`${revision ?? JSON.stringify(params)} ${shown?.join() ?? ""}`}
            window={shown}
            onReady={setHandle}
            {...events}
            onWindow={
              onWindow &&
              ((next) => {
                onWindow(next && [rounded(next[0] / factor), rounded(next[1] / factor)]);
              })
            }
          />
        </FigureBoundary>
      )}
    </section>
  );
}

/** Fetches a figure, and Plotly, before what is around is known; without parameters neither. */
export function usePrefetchedFigure(kind: string, given: Record<string, QueryValue> | null) {
  const cache = useQueryClient();
  const units = useUnitParameters();
  const key = given && JSON.stringify({ ...given, ...units });
  useEffect(() => {
    if (key === null) return;
    loadPlotly().catch(() => undefined);
    const request = figureQuery(kind, JSON.parse(key) as Record<string, QueryValue>);
    cache.query(request).catch(() => undefined); // the figure itself reports it
  }, [cache, kind, key]);
}

/** Without data there is no figure and no retry. */
function Undrawn({ error, onRetry }: { error: unknown; onRetry: () => void }) {
  const { status, detail } = asProblem(error);
  if (status !== 409 && status !== 422) return <ProblemAlert error={error} onRetry={onRetry} />;
  return <Empty title="No data">{detail}</Empty>;
}

function idsIn(params: Record<string, QueryValue>): (string | number)[] {
  return Object.entries(params).flatMap(([key, value]) =>
    key.endsWith("_id") && (typeof value === "number" || typeof value === "string") ? [value] : [],
  );
}
