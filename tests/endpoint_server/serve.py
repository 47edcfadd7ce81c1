"""Serves a checkpoint over the OpenAI protocol, one question at a time, and keeps to a JSON schema by a grammar.

`transformers serve` is the other server that the tests use; it ignores schemas. This one honours `response_format`,
`seed`, `temperature` and `max_tokens`, so that even random weights give JSON of the right shape.
"""

import base64
import io
import json
import sys
from http.server import BaseHTTPRequestHandler, HTTPServer

import llguidance
import llguidance.hf
import llguidance.torch
import torch
from PIL import Image
from transformers import AutoModelForImageTextToText, AutoProcessor, LogitsProcessor, LogitsProcessorList

MODEL_NAME = "tiny"


class Grammar(LogitsProcessor):
    """Lets only those tokens through that the schema allows next."""

    def __init__(self, tokenizer, schema: dict, prompt_length: int) -> None:
        grammar = llguidance.LLMatcher.grammar_from_json_schema(schema, {"whitespace_flexible": False})
        self.matcher = llguidance.LLMatcher(tokenizer, grammar)
        self.mask = llguidance.torch.allocate_token_bitmask(1, tokenizer.vocab_size)
        self.prompt_length = prompt_length

    def __call__(self, tokens, scores):
        if tokens.shape[1] > self.prompt_length:
            self.matcher.consume_token(int(tokens[0, -1]))
        llguidance.torch.fill_next_token_bitmask(self.matcher, self.mask, 0)
        llguidance.torch.apply_token_bitmask_inplace(scores, self.mask)
        return scores


class Teller:
    """A loaded checkpoint."""

    def __init__(self, folder: str) -> None:
        self.model = AutoModelForImageTextToText.from_pretrained(folder, local_files_only=True).eval()
        self.processor = AutoProcessor.from_pretrained(folder, local_files_only=True)
        vocabulary = self.model.config.text_config.vocab_size
        self.grammar_tokenizer = llguidance.hf.from_tokenizer(self.processor.tokenizer, n_vocab=vocabulary)

    def tell(self, question: dict) -> dict:
        images = []
        text = self.processor.apply_chat_template(
            [spelled(message, images) for message in question["messages"]], add_generation_prompt=True, tokenize=False
        )
        inputs = self.processor(text=[text], images=images or None, return_tensors="pt")
        length = inputs["input_ids"].shape[1]
        format = question.get("response_format") or {}
        grammars = LogitsProcessorList()
        if format.get("type") == "json_schema":
            grammars.append(Grammar(self.grammar_tokenizer, format["json_schema"]["schema"], length))
        temperature = question.get("temperature", 1.0)
        sampling = {"do_sample": True, "temperature": temperature} if temperature > 0 else {"do_sample": False}
        torch.manual_seed(question.get("seed", 0))
        limit = question.get("max_tokens", 256)
        with torch.no_grad():
            tokens = self.model.generate(
                **inputs,
                **sampling,
                max_new_tokens=limit,
                logits_processor=grammars,
                eos_token_id=self.processor.tokenizer.eos_token_id,
            )[0, length:]
        stopped = int(tokens[-1]) == self.processor.tokenizer.eos_token_id
        return {
            "object": "chat.completion",
            "model": MODEL_NAME,
            "system_fingerprint": f"torch-{torch.__version__}",
            "choices": [
                {
                    "index": 0,
                    "message": {
                        "role": "assistant",
                        "content": self.processor.tokenizer.decode(tokens, skip_special_tokens=True),
                    },
                    "finish_reason": "stop" if stopped else "length",
                }
            ],
            "usage": {"prompt_tokens": length, "completion_tokens": len(tokens), "total_tokens": length + len(tokens)},
        }


def spelled(message: dict, images: list) -> dict:
    """A message as the template wants it; its pictures are appended to `images`."""
    if isinstance(message["content"], str):
        return message
    for part in message["content"]:
        if part["type"] == "image_url":
            encoded = part["image_url"]["url"].split(",", 1)[1]
            images.append(Image.open(io.BytesIO(base64.b64decode(encoded))).convert("RGB"))
    return message


class Handler(BaseHTTPRequestHandler):
    teller: Teller

    def do_GET(self) -> None:
        self.answer(200, {"object": "list", "data": [{"id": MODEL_NAME, "object": "model"}]})

    def do_POST(self) -> None:
        question = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        if question["model"] != MODEL_NAME:
            self.answer(404, {"error": {"message": f"no such model: {question['model']}"}})
            return
        try:
            self.answer(200, self.teller.tell(question))
        except Exception as error:
            self.answer(500, {"error": {"message": f"{type(error).__name__}: {error}"}})

    def answer(self, status: int, body: dict) -> None:
        encoded = json.dumps(body).encode()
        self.send_response(status)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(encoded)))
        self.end_headers()
        self.wfile.write(encoded)

    def log_message(self, *args) -> None:
        pass


def main(folder: str, port: str) -> None:
    torch.set_num_threads(1)
    Handler.teller = Teller(folder)
    HTTPServer(("127.0.0.1", int(port)), Handler).serve_forever()


if __name__ == "__main__":
    main(*sys.argv[1:])
