// Errors: the class says what is wrong, `argument` where.

/** Any error of this package. */
export class ColltransError extends Error {
  override name = "ColltransError";

  constructor(
    message: string,
    /** The argument at fault, for example `direction`; empty if no single argument is. */
    readonly argument = "",
  ) {
    super(argument && !message.startsWith(argument) ? `${argument}: ${message}` : message);
  }
}

/** An argument has the wrong form. */
export class InputError extends ColltransError {
  override name = "InputError";
}

/** Points or faces do not form a body. The message names the place. */
export class BuildError extends ColltransError {
  override name = "BuildError";
}

/** Numbers do not describe a pose. */
export class PoseError extends ColltransError {
  override name = "PoseError";
}

/** A direction, a length or an option is rejected. */
export class QueryError extends ColltransError {
  override name = "QueryError";
}

/** The search ended without an answer. */
export class NotConvergedError extends ColltransError {
  override name = "NotConvergedError";
}

/** The library stopped: it ran out of memory, or it has a defect. Its bodies are lost; reload the module. */
export class StoppedError extends ColltransError {
  override name = "StoppedError";
}

const CLASSES: Record<string, new (message: string, argument?: string) => ColltransError> = {
  InputError, BuildError, PoseError, QueryError, NotConvergedError,
};

/** Builds the error of a text of the library: kind, argument and message, each on a line. */
export function errorOf(text: string): ColltransError {
  const [kind = "", argument, ...message] = text.split("\n");
  return new (CLASSES[kind] ?? ColltransError)(message.join("\n"), argument);
}
