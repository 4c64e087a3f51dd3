import { Button, Group, Modal, Select, Stack, TextInput } from "@mantine/core";
import { useNavigate, useSearch } from "@tanstack/react-router";
import { useMemo, useState } from "react";
import { storePreference, usePreference } from "../../api/preference";
import {
  FONT_PT,
  isOfPage,
  knownFormat,
  presetOf,
  PRESETS,
  SIZE_MM,
  type PrintFormat,
} from "../../lib/figures/printFormat";
import { NumberField } from "../controls/NumberField";

const KEY = "flexsid.print-format";
const LABELS = {
  width_mm: "Width [mm]",
  height_mm: "Height [mm]",
  font_pt: "Font [pt]",
} as const;

/** The size and font of printed figures: of this address, else what the user prefers. */
export function usePrintFormat(): PrintFormat {
  const preferred = usePreference(KEY);
  const search: PrintFormat = useSearch({ strict: false });
  return useMemo(() => {
    const own = knownFormat(search);
    return isOfPage(own) ? knownFormat(preferred) : own;
  }, [search, preferred]);
}

interface Props {
  /** Heading of the figure, proposed as title. */
  name: string;
  onClose: () => void;
  onImage: (format: "png" | "svg", title: string) => void;
  /** None for a figure that is not stored. */
  onPdf?: (title: string) => void;
  /** Address of the figure as JSON with this title. */
  json: (title: string) => { href: string; download: string };
}

/** Size, font and title of a figure for print, and its files. */
export function PrintFigure({ name, onClose, onImage, onPdf, json }: Props) {
  const format = usePrintFormat();
  const navigate = useNavigate();
  const search: PrintFormat = useSearch({ strict: false });
  const [title, setTitle] = useState("");
  const [isOwn, setOwn] = useState(presetOf(format) === "own");
  const address = (next: PrintFormat) =>
    void navigate({
      to: ".",
      search: (before: object) => ({ ...before, ...EMPTY, ...next }),
      replace: true,
    });
  const isInAddress = !isOfPage(knownFormat(search));
  const set = (next: PrintFormat) => {
    storePreference(KEY, next);
    if (isInAddress) address({});
  };
  const choose = (value: string | null) => {
    setOwn(value === "own");
    if (value === "page") set({});
    const preset = PRESETS.find((one) => one.value === value);
    if (preset !== undefined) set(knownFormat(preset));
  };
  return (
    <Modal opened onClose={onClose} title={`Print ${name}`} size="lg">
      <Stack gap="sm">
        <Group align="flex-end" gap="sm">
          <Select
            label="Size"
            w={170}
            allowDeselect={false}
            data-testid="print-size"
            data={[
              { value: "page", label: "As on the page" },
              ...PRESETS.map(({ value, label }) => ({ value, label })),
              { value: "own", label: "Own size" },
            ]}
            value={isOwn ? "own" : presetOf(format)}
            onChange={choose}
          />
          {(Object.keys(LABELS) as (keyof PrintFormat)[]).map((key) => {
            const [min, max] = key === "font_pt" ? FONT_PT : SIZE_MM;
            return (
              <NumberField
                key={key}
                label={LABELS[key]}
                w={110}
                min={min}
                max={max}
                decimalScale={1}
                placeholder="of the page"
                value={format[key]}
                onChange={(value) => {
                  setOwn(true);
                  set({ ...format, [key]: value });
                }}
              />
            );
          })}
        </Group>
        <Group align="flex-end" gap="sm">
          <TextInput
            label="Title"
            placeholder="none"
            flex={1}
            maxLength={200}
            value={title}
            onChange={(event) => {
              setTitle(event.currentTarget.value);
            }}
          />
          <Button
            variant="default"
            onClick={() => {
              setTitle(name);
            }}
          >
            Title of the page
          </Button>
        </Group>
        <Group justify="space-between">
          <Button
            variant="subtle"
            disabled={isOfPage(format)}
            onClick={() => {
              address(isInAddress ? {} : format);
            }}
          >
            {isInAddress ? "Remove this size from the address" : "Put this size into the address"}
          </Button>
          <Group gap="xs">
            {(["png", "svg"] as const).map((image) => (
              <Button
                key={image}
                data-testid={`print-${image}`}
                onClick={() => {
                  onImage(image, title);
                }}
              >
                {image.toUpperCase()}
              </Button>
            ))}
            {onPdf !== undefined && (
              <Button
                data-testid="print-pdf"
                onClick={() => {
                  onPdf(title);
                }}
              >
                PDF
              </Button>
            )}
            <Button component="a" variant="default" {...json(title)}>
              JSON
            </Button>
          </Group>
        </Group>
      </Stack>
    </Modal>
  );
}

const EMPTY = { width_mm: undefined, height_mm: undefined, font_pt: undefined };
